#include "core/map/map_records.h"

#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "tests/fuzz/format.h"
#include "tests/fuzz/golden_map.h"
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

/// Records say nothing of their version: any may be the right one.
Expected<MarkerMap> decode_any(const std::string& payload) {
  auto map = decode(payload, 1);
  for (std::uint32_t version = 2; !map && version <= kMapContainerVersion; ++version) {
    map = decode(payload, version);
  }
  return map;
}

const AddFormat records({"MapRecords",
                         {encode_records(small_map()), encode_records(considered_small_map()),
                          golden_map(1).substr(kContainerHeaderBytes),
                          golden_map(2).substr(kContainerHeaderBytes),
                          golden_map(3).substr(kContainerHeaderBytes)},
                         {},
                         reader(decode_any)});

}  // namespace
}  // namespace waymark::test
