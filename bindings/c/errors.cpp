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

const char* name_of(tactus_status status) noexcept {
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

}  // namespace

tactus_status report(tactus_status status, const Error& error, tactus_error* out) noexcept {
  if (out == nullptr) return status;
  *out = {.status = status,
          .advice = static_cast<std::int32_t>(advice(error)),
          .bit_offset = error.bit_offset,
          .name = name_of(status),
          .rule = error.rule,
          .text = describe(error),
          .remedy = remedy(error),
          .object = "",
          .detail = ""};
  return status;
}

tactus_status report(const Error& error, tactus_error* out) noexcept {
  return report(static_cast<tactus_status>(error.code), error, out);
}

}  // namespace tactus::c

using namespace tactus;

uint32_t tactus_version(void) { return TACTUS_VERSION; }

tactus_status tactus_describe(tactus_status status, const char* rule, tactus_error* error) {
  if (error == nullptr) return TACTUS_INVALID_ARGUMENT;
  c::report(status, {static_cast<Errc>(status), rule != nullptr ? rule : "", 0}, error);
  return TACTUS_OK;
}
