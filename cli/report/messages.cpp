// SPDX-License-Identifier: Apache-2.0
#include "cli/report/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <tactus/base/shown.h>

namespace tactus::cli {
namespace {

tl::unexpected<Failure> refuse_with(std::string text, const std::string& file, const std::string& location, const Error& error) {
  auto refused = refuse(std::move(text), "");
  refused.value().file = file;
  refused.value().location = location;
  refused.value().error_class = errc_name(error.code);
  refused.value().rule = error.rule;
  return refused;
}

}  // namespace

std::string location_of_bit(std::uint64_t bit_offset) {
  if (bit_offset == 0) return {};
  if (bit_offset % 8 == 0) return fmt::format("byte {}", bit_offset / 8);
  return fmt::format("byte {}, bit {}", bit_offset / 8, bit_offset % 8);
}

tl::unexpected<Failure> refuse(const std::string& file, const std::string& location, const Error& error) {
  const int cause = error.code == Errc::io ? errno : 0;
  auto refused =
      refuse_with(fmt::format("{}{}{}: {}{}{} ({}, {})", shown_path(file), location.empty() ? "" : ", ", location,
                              describe(error), cause == 0 ? "" : ": ", cause == 0 ? "" : std::generic_category().message(cause),
                              errc_name(error.code), error.rule),
                  file, location, error);
  refused.value().remedy = cause == 0 ? remedy(error) : remedy_of(cause);
  return refused;
}

tl::unexpected<Failure> refuse(const Diagnostic& error) {
  return refuse_with(to_string(error), error.file, location_of(error), error.error);
}

tl::unexpected<Failure> refuse(const std::string& file, const Diagnostic& error) {
  const std::string location = location_of(error);
  auto refused = refuse(file, location, error.error);
  if (!error.cause.empty())
    refused.value().text = fmt::format("{}{}{}: {} ({}, {})", shown_path(file), location.empty() ? "" : ", ", location,
                                       error.cause, errc_name(error.error.code), error.error.rule);
  if (!error.remedy.empty()) refused.value().remedy = error.remedy;
  return refused;
}

tl::unexpected<Failure> refuse(const std::string& file, const Error& error) {
  return refuse(file, location_of_bit(error.bit_offset), error);
}

std::string remedy_of(int cause) {
  switch (cause) {
    case ENOSPC:
    case EDQUOT:
      return "Free space on this disk, or write to another one.";
    case EACCES:
    case EPERM:
    case EROFS:
      return "Check your permissions for this file and its folder.";
    case ENOENT:
    case ENOTDIR:
      return "Check that the path is right.";
    default:
      return "Check the path and your permissions.";
  }
}

tl::unexpected<Failure> refuse_io(const std::string& file, const std::string& what, int cause) {
  auto refused = refuse(shown_path(file) + ": " + what + ": " + std::generic_category().message(cause), remedy_of(cause));
  refused.value().file = file;
  refused.value().error_class = errc_name(Errc::io);
  return refused;
}

std::string printable(std::string_view message) {
  constexpr std::size_t kLongestLine = 2000;
  std::string out;
  while (true) {
    const std::size_t end = std::min(message.find('\n'), message.size());
    out += shown(message.substr(0, end), kLongestLine);
    if (end == message.size()) return out;
    out += '\n';
    message.remove_prefix(end + 1);
  }
}

tl::unexpected<Failure> refuse(std::string text, std::string remedy) {
  return tl::unexpected(Failure{std::move(text), std::move(remedy)});
}

tl::unexpected<Failure> refuse_arguments(std::string text, std::string remedy) {
  return tl::unexpected(Failure{std::move(text), std::move(remedy), Failure::Cause::arguments});
}

}  // namespace tactus::cli
