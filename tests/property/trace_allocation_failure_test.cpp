// SPDX-License-Identifier: Apache-2.0
/// Each call of operator new fails once while recordings are read, written and imported: an error, no exception, no leak.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/trace/csv.h>
#include <tactus/trace/trace_file.h>
#include "tests/fuzz/pack.h"
#include "tests/property/fail_each.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::fail_each;

Result<void> read_all(const Bytes& bytes) {
  auto reader = TraceReader::open_memory(bytes);
  if (!reader) return tl::unexpected(reader.error());
  for (TraceFrame frame;;) {
    const auto more = reader->next(frame);
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
  }
}

/// Small recordings, ours and those of others, that are read to their end.
std::vector<Bytes> recordings() {
  constexpr std::size_t kMost = 40, kLargest = 6000;
  std::ifstream in(TACTUS_TRACES, std::ios::binary);
  const Bytes pack{std::istreambuf_iterator<char>(in), {}};
  std::vector<Bytes> out;
  EXPECT_TRUE(for_each_packed(pack, [&](std::span<const std::uint8_t> packed) {
    Bytes bytes(packed.begin(), packed.end());
    if (out.size() < kMost && bytes.size() <= kLargest && read_all(bytes)) out.push_back(std::move(bytes));
  }));
  return out;
}

TEST(TraceAllocationFailure, Reading) {
  const std::vector<Bytes> all = recordings();
  EXPECT_GT(all.size(), 5u);
  for (const Bytes& bytes : all) EXPECT_GT(fail_each(bytes, read_all), 5u);
}

struct Recording {
  TraceInfo info;
  TraceFrame frame;
};

Result<void> write_two_ticks(Recording&& recording) {
  auto writer = TraceWriter::create("/dev/null", recording.info);
  if (!writer) return tl::unexpected(writer.error());
  for (recording.frame.tick = 0; recording.frame.tick < 2; ++recording.frame.tick)
    if (const auto done = writer->write(recording.frame); !done) return done;
  return writer->finish();
}

TEST(TraceAllocationFailure, Writing) {
  Recording recording;
  TraceInfo& info = recording.info;
  info.objects = {{"an object with a name too long for a small string", Dof::all}, {"wall", Dof::none}};
  info.users = {{"somebody"}};
  info.scene = "name = \"a scene with a text\"";
  recording.frame.objects.resize(info.objects.size());
  recording.frame.users.resize(info.users.size());
  EXPECT_GT(fail_each(recording, write_two_ticks), 20u);
}

TEST(TraceAllocationFailure, Import) {
  const std::string_view text =
      "toss,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n0,0,0,0,1,0,0,0,0,0,0,0,0,0\n0,1,0,0,1,0,0,0,0,0,0,0,0,0\n";
  const int file = memfd_create("csv", 0);
  ASSERT_EQ(write(file, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  const CsvMapping mapping = csv_presets()[1].mapping;
  const auto import = [&](const std::string& path) -> Result<void> {
    const auto done = import_csv(path, mapping, "/dev/null");
    if (!done) return tl::unexpected(done.error().error);
    return {};
  };
  EXPECT_GT(fail_each("/proc/self/fd/" + std::to_string(file), import), 20u);
  close(file);
}

}  // namespace
}  // namespace tactus
