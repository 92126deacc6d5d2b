// SPDX-License-Identifier: Apache-2.0
#include <tactus/file/stream_file.h>

#include <memory>
#include <ostream>
#include <streambuf>
#include <vector>

#include "handles.h"

namespace tactus::c {
namespace {

/// Keeps what is written until it is taken.
class Buffer : public std::streambuf {
 public:
  std::span<const std::uint8_t> bytes() const noexcept { return bytes_; }
  void clear() noexcept { bytes_.clear(); }

 protected:
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    bytes_.insert(bytes_.end(), data, data + size);
    return size;
  }
  int_type overflow(int_type c) override {
    if (!traits_type::eq_int_type(c, traits_type::eof())) bytes_.push_back(static_cast<std::uint8_t>(c));
    return traits_type::not_eof(c);
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace
}  // namespace tactus::c

struct tactus_writer {
  tactus::c::Buffer buffer;
  std::ostream out{&buffer};
  std::optional<tactus::StreamFileWriter> file{};
  bool finished = false;
};

using namespace tactus;
using namespace tactus::c;

namespace {

/// err  R-API-12 null; R-API-5 the file has its end
Outcome check(const tactus_writer* writer) noexcept {
  if (writer == nullptr) return refuse();
  if (writer->finished) return fail(Errc::invalid_argument, "R-API-5");
  return TACTUS_OK;
}

}  // namespace

tactus_status tactus_writer_create(const tactus_scene* scene, tactus_writer** writer, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (scene == nullptr || !scene->shared || writer == nullptr) return refuse();
    auto made = std::make_unique<tactus_writer>();
    TACTUS_TRY(made->file, StreamFileWriter::create(made->out, *scene->shared));
    *writer = made.release();
    return TACTUS_OK;
  });
}

void tactus_writer_destroy(tactus_writer* writer) { delete writer; }

tactus_status tactus_writer_add(tactus_writer* writer, int64_t tick, uint64_t number, const uint8_t* packet, size_t size,
                                uint32_t key, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(check(writer));
    TACTUS_TRY(const auto bytes, span_of(packet, size));
    TACTUS_CHECK(writer->file->add(tick, number, bytes, key != 0));
    return TACTUS_OK;
  });
}

tactus_status tactus_writer_finish(tactus_writer* writer, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(check(writer));
    TACTUS_CHECK(writer->file->finish());
    writer->finished = true;
    return TACTUS_OK;
  });
}

tactus_status tactus_writer_take(tactus_writer* writer, uint8_t* bytes, size_t capacity, size_t* size, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (writer == nullptr) return refuse();
    TACTUS_TRY(const tactus_status copied, copy_out(writer->buffer.bytes(), bytes, capacity, size));
    if (copied == TACTUS_OK) writer->buffer.clear();
    return copied;
  });
}
