// SPDX-License-Identifier: Apache-2.0
/// Runs a fuzz target over files, for compilers without libFuzzer: `<stem>_fuzz FILE|FOLDER|PACK.pack...`, folders in the order of their
/// names.
/// The C library alone, since MemorySanitizer knows it and not what the C++ library's streams do.
#include <dirent.h>

#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>

#include "tests/fuzz/pack.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::size_t replayed = 0;

void replay_input(std::span<const std::uint8_t> input) {
  LLVMFuzzerTestOneInput(input.data(), input.size());
  ++replayed;
}

/// Every input in a heap block of exactly its size, so that AddressSanitizer sees the first byte read past it.
bool replay_file(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file || std::fseek(file.get(), 0, SEEK_END) != 0) return false;
  const long end = std::ftell(file.get());
  if (end < 0 || end == LONG_MAX) return false;
  const auto size = static_cast<std::size_t>(end);
  std::rewind(file.get());
  const std::unique_ptr<std::uint8_t[]> bytes(new std::uint8_t[size]);
  if (std::fread(bytes.get(), 1, size, file.get()) != size) return false;
  if (!path.ends_with(".pack")) {
    replay_input({bytes.get(), size});
    return true;
  }
  return for_each_packed({bytes.get(), size}, [](std::span<const std::uint8_t> packed) {
    const std::unique_ptr<std::uint8_t[]> input(new std::uint8_t[packed.size()]);
    if (!packed.empty()) std::memcpy(input.get(), packed.data(), packed.size());
    replay_input({input.get(), packed.size()});
  });
}

bool replay(const std::string& path) {
  dirent** entries = nullptr;
  const int count = scandir(path.c_str(), &entries, nullptr, alphasort);
  bool all = count >= 0 || replay_file(path);
  for (int i = 0; i < count; ++i) {
    const std::string name = entries[i]->d_name;
    std::free(entries[i]);
    if (all && name != "." && name != "..") all = replay(path + '/' + name);
  }
  std::free(entries);
  if (!all && count < 0) std::fprintf(stderr, "%s: cannot be read\n", path.c_str());
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (!replay(argv[i])) return 1;
  std::printf("%zu inputs\n", replayed);
  return replayed > 0 ? 0 : 1;
}
