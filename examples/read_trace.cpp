// SPDX-License-Identifier: Apache-2.0
/// Print how far each object of a trace travelled and how long its users touched something.   usage: read_trace TRACE.mcap
#include <cstdio>
#include <vector>

#include <tactus/trace/trace_file.h>

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: read_trace TRACE.mcap\n"), 2;
  auto reader = tactus::TraceReader::open(argv[1]);
  if (!reader) return std::fprintf(stderr, "%s: %s\n", argv[1], describe(reader.error())), 1;
  const tactus::TraceInfo info = reader->info();
  std::vector<double> travelled(info.objects.size());
  std::vector<tactus::Vec3> last(info.objects.size());
  std::vector<int> touched(info.users.size());
  tactus::TraceFrame frame;
  for (int ticks = 0;; ++ticks) {
    const auto more = reader->next(frame);
    if (!more) return std::fprintf(stderr, "%s: %s\n", argv[1], describe(more.error())), 1;
    if (!*more) break;
    for (std::size_t i = 0; i < travelled.size(); ++i) {
      const tactus::Vec3& at = frame.objects[i].pose.position;
      if (ticks > 0) travelled[i] += tactus::norm(at - last[i]);
      last[i] = at;
    }
    for (std::size_t i = 0; i < touched.size(); ++i)
      touched[i] += frame.users[i].contact.kind != tactus::ContactKind::none || frame.users[i].surface_contact ? 1 : 0;
  }
  for (std::size_t i = 0; i < travelled.size(); ++i)
    std::printf("%s travelled %.3f m\n", info.objects[i].name.c_str(), travelled[i]);
  for (std::size_t i = 0; i < touched.size(); ++i)
    std::printf("%s touched something for %.3f s\n", info.users[i].name.c_str(),
                touched[i] / static_cast<double>(info.tick_rate));
}
