// The report page of builds without WAYMARK_REPORT_PAGE: the figures as they are, and where the
// drawn page comes from.
#include "mapbuilder/report/page_template.h"
#include "mapbuilder/report/report_page.h"

namespace waymark {
namespace {

const std::string_view kBefore[] = {
    kPageMark,
    "<html lang=\"en\"><meta charset=\"utf-8\">"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\">"
    "<title>Map report</title>"
    "<p>This mapbuilder was built without the report page (WAYMARK_REPORT_PAGE=OFF): plan, 3D view "
    "and tables are not here. summary.json beside this page holds the figures. These are the "
    "page's data:</p><pre>",
};
const std::string_view kAfter[] = {"</pre></html>\n"};

}  // namespace

std::span<const std::string_view> page_before_data() { return kBefore; }
std::span<const std::string_view> page_after_data() { return kAfter; }

}  // namespace waymark
