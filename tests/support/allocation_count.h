#pragma once

namespace waymark::testing {

/// How often this program has taken memory by `new` so far. A test that links
/// waymark_test_allocations has its operators new and delete replaced by counting ones.
[[nodiscard]] long allocations();

}  // namespace waymark::testing
