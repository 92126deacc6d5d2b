// SPDX-License-Identifier: Apache-2.0
/// A byte that picks the mapping and whether the rest is to be packed, then any bytes as a text with commas, plain or zstd: an error
/// with rule and line, or a trace.
#include <sys/mman.h>
#include <unistd.h>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <tactus/trace/byte_source.h>
#include <tactus/trace/csv.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus;

CsvMapping mapping(unsigned choice) {
  const auto& presets = csv_presets();
  if (choice % 4 < presets.size()) return presets[choice % 4].mapping;
  CsvMapping by_time;
  by_time.time = choice & 4 ? "t,n" : "t";  // a date and a time of day
  by_time.restarts = choice & 4;
  by_time.segment = choice & 8 ? "s" : "";
  by_time.position = {"x", "y", "z"};
  by_time.rotation = {"a", "b", "c", "d"};
  by_time.object_column = choice & 32 ? "o" : "";
  by_time.axes = {1, -3, 2};
  by_time.skip_bad = choice & 64;
  by_time.resample = !(choice & 128);
  return by_time;
}

/// A file that is only in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::uint8_t> bytes) : handle_(memfd_create("csv", 0)) {
    require(handle_ >= 0 && write(handle_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  ~MemoryFile() { close(handle_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(handle_); }

 private:
  int handle_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::span<const std::uint8_t> text(data + 1, size - 1);
  Compressor zstd;
  if (data[0] & 16) text = zstd.compress(text).value();
  const auto lines = static_cast<std::size_t>(
                         std::count_if(data + 1, data + size, [](std::uint8_t byte) { return byte == '\n' || byte == '\r'; })) +
                     1;
  const auto done = import_csv(MemoryFile(text).path(), mapping(data[0]), "/dev/null");
  if (done) require(done->ticks.count() > 0 && (done->ticks.count() <= lines || (data[0] & 3) == 3) && done->segments > 0);
  else require(done.error().error.rule[0] == 'R' && (done.error().line <= lines + 1 || text[0] == 0x28));
  return 0;
}
