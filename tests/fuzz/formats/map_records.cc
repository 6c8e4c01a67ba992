#include "core/map/map_records.h"

#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "tests/fuzz/format.h"
#include "tests/support/small_map.h"

namespace waymark::test {
namespace {

/// As decode_map has it behind a right checksum.
Expected<MarkerMap> decode(const std::string& payload, std::uint32_t version) {
  auto map = decode_records(payload, version);
  if (!map) return map;
  if (auto sound = check_map(*map); !sound) return tl::make_unexpected(sound.error());
  (void)encode_map(*map).value();  // what is taken can be written
  return map;
}

const AddFormat records(
    {"MapRecords", {encode_records(small_map())}, {}, reader([](const std::string& payload) {
       (void)decode(payload, 1);
       return decode(payload, kMapContainerVersion);
     })});

}  // namespace
}  // namespace waymark::test
