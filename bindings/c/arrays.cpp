// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/array_trace.h>

#include <cmath>
#include <memory>
#include <string>

#include "trace_handle.h"

struct tactus_arrays {
  tactus::SampledArrays arrays;
  std::string notes;
};

using namespace tactus;
using namespace tactus::c;

namespace {

/// Rows of the caller; empty: not there.
std::span<const double> rows_of(const tactus_arrays& arrays, const double* values, std::size_t width) noexcept {
  return values == nullptr ? std::span<const double>() : std::span(values, width * arrays.arrays.time.size());
}

std::string text_of(const ReadNote& note) {
  std::string out = (note.where.empty() ? "" : note.where + ": ") + note.what;
  if (note.count > 1) out += " (" + std::to_string(note.count) + (note.first.empty() ? ")" : "; first " + note.first + ")");
  else if (!note.first.empty()) out += " (" + note.first + ")";
  return out;
}

std::string text_of(const ReadNotes& notes) {
  std::string out;
  for (const ReadNote& note : notes.all()) out += text_of(note) + '\n';
  return out;
}

}  // namespace

tactus_status tactus_arrays_create(const int64_t* time, size_t rows, uint32_t tick_rate, double gap, const char* source,
                                   tactus_arrays** arrays, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const auto times, span_of(time, rows));
    if (arrays == nullptr) return refuse();
    if (!(gap >= 0 && gap <= 3600)) return fail(Errc::invalid_argument, "R-API-4");
    auto out = std::make_unique<tactus_arrays>();
    out->arrays.time = times;
    out->arrays.tick_rate = tick_rate;
    if (gap > 0) out->arrays.gap = gap;
    if (source != nullptr) out->arrays.source = source;
    *arrays = out.release();
    return TACTUS_OK;
  });
}

void tactus_arrays_destroy(tactus_arrays* arrays) { delete arrays; }

tactus_status tactus_arrays_object(tactus_arrays* arrays, const char* name, const double* position, const double* rotation,
                                   const double* velocity, const double* angular_velocity, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (arrays == nullptr || name == nullptr || position == nullptr) return refuse();
    arrays->arrays.objects.push_back({.name = name,
                                      .position = rows_of(*arrays, position, 3),
                                      .rotation = rows_of(*arrays, rotation, 4),
                                      .velocity = rows_of(*arrays, velocity, 3),
                                      .angular_velocity = rows_of(*arrays, angular_velocity, 3)});
    return TACTUS_OK;
  });
}

tactus_status tactus_arrays_user(tactus_arrays* arrays, const char* name, const double* device, const double* rotation,
                                 const double* force, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (arrays == nullptr || name == nullptr) return refuse();
    SampledUser user{.name = name, .device = rows_of(*arrays, device, 3), .force = rows_of(*arrays, force, 3)};
    user.rotation = rows_of(*arrays, rotation, 4);
    arrays->arrays.users.push_back(std::move(user));
    return TACTUS_OK;
  });
}

tactus_status tactus_arrays_contact(tactus_arrays* arrays, const char* user, const char* object, double stiffness, int32_t kind,
                                    int32_t at_origin, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (arrays == nullptr || user == nullptr || object == nullptr) return refuse();
    if (kind != TACTUS_CONTACT_SURFACE && kind != TACTUS_CONTACT_SPRING) return refuse();
    arrays->arrays.contacts.push_back({.user = user,
                                       .object = object,
                                       .stiffness = stiffness,
                                       .kind = kind == TACTUS_CONTACT_SURFACE ? ContactKind::surface : ContactKind::spring,
                                       .at = at_origin != 0 ? ForcePoint::origin : ForcePoint::device});
    return TACTUS_OK;
  });
}

tactus_status tactus_arrays_write(tactus_arrays* arrays, const char* path, const char** notes, tactus_error* error) {
  return call_with_words(error, [&]() -> Outcome {
    if (arrays == nullptr || path == nullptr) return refuse();
    ReadNotes taken;
    const auto written = write_arrays(arrays->arrays, path, taken);
    arrays->notes = text_of(taken);
    if (notes != nullptr) *notes = arrays->notes.c_str();
    if (written) return TACTUS_OK;
    if (!taken.all().empty()) error_words() = text_of(taken.all().back());
    return tl::make_unexpected(written.error());
  });
}
