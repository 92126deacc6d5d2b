// SPDX-License-Identifier: Apache-2.0
#include "handles.h"

namespace tactus::c {
namespace {

static_assert(TACTUS_TRUNCATED == static_cast<int>(Errc::truncated) && TACTUS_MALFORMED == static_cast<int>(Errc::malformed) &&
              TACTUS_INVALID == static_cast<int>(Errc::invalid) && TACTUS_UNSUPPORTED == static_cast<int>(Errc::unsupported) &&
              TACTUS_LIMIT_EXCEEDED == static_cast<int>(Errc::limit_exceeded) &&
              TACTUS_CHECKSUM == static_cast<int>(Errc::checksum) && TACTUS_STATE == static_cast<int>(Errc::state) &&
              TACTUS_INVALID_ARGUMENT == static_cast<int>(Errc::invalid_argument) && TACTUS_IO == static_cast<int>(Errc::io) &&
              TACTUS_INTERNAL == static_cast<int>(Errc::internal));
static_assert(TACTUS_ADVICE_NONE == static_cast<int>(Advice::none) && TACTUS_ADVICE_DROP == static_cast<int>(Advice::drop) &&
              TACTUS_ADVICE_REQUEST_KEY == static_cast<int>(Advice::request_key) &&
              TACTUS_ADVICE_CLOSE == static_cast<int>(Advice::close));

Error error_of(const tactus_error* error) noexcept {
  if (error == nullptr || error->rule == nullptr) return {Errc::internal, "", 0};
  return {static_cast<Errc>(error->status), error->rule, error->bit_offset};
}

}  // namespace

tactus_status report(const Error& error, tactus_error* out) noexcept {
  const auto status = static_cast<tactus_status>(error.code);
  if (out != nullptr) *out = {status, error.rule, error.bit_offset};
  return status;
}

}  // namespace tactus::c

using namespace tactus;

uint32_t tactus_version(void) { return TACTUS_VERSION; }

const char* tactus_status_name(tactus_status status) {
  switch (status) {
    case TACTUS_OK:
      return "ok";
    case TACTUS_NOTHING:
      return "nothing";
    case TACTUS_BUFFER_TOO_SMALL:
      return "buffer_too_small";
    default:
      break;
  }
  const bool is_class = status > 0 && status <= TACTUS_INTERNAL;
  return is_class ? errc_name(static_cast<Errc>(status)) : "unknown";
}

const char* tactus_error_text(const tactus_error* error) { return describe(c::error_of(error)); }
const char* tactus_error_remedy(const tactus_error* error) { return remedy(c::error_of(error)); }
int32_t tactus_error_advice(const tactus_error* error) { return static_cast<int32_t>(advice(c::error_of(error))); }
