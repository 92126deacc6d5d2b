// SPDX-License-Identifier: Apache-2.0
#include "cli/viewer/page.h"

#include <fmt/format.h>

#include <sstream>

// Of page.S.
extern "C" const char tactus_page_begin[], tactus_page_end[];

namespace tactus::cli {
namespace {

constexpr std::string_view kDataMarker = "<!--tactus-data-->", kConnect = "connect-src 'none'";

}  // namespace

std::string_view page_template() noexcept {
  return {tactus_page_begin, static_cast<std::size_t>(tactus_page_end - tactus_page_begin)};
}

std::string page_json(const nlohmann::ordered_json& data) {
  const std::string text = data.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {  // outside of strings JSON has none of these
    if (c == '<') out += "\\u003c";
    else if (c == '>') out += "\\u003e";
    else if (c == '&') out += "\\u0026";
    else out += c;
  }
  return out;
}

void write_page(std::ostream& out, std::string_view data) {
  const std::string_view page = page_template();
  const std::size_t at = page.find(kDataMarker);
  out << page.substr(0, at) << R"(<script id="tactus-data" type="application/json">)" << data << "</script>"
      << page.substr(at + kDataMarker.size());
}

std::string live_page(std::uint16_t port) {
  std::ostringstream page;
  write_page(page, R"({"live":true})");
  std::string text = page.str();
  const std::string sources = fmt::format("connect-src ws://127.0.0.1:{0} ws://localhost:{0}", port);
  text.replace(text.find(kConnect), kConnect.size(), sources);
  return text;
}

}  // namespace tactus::cli
