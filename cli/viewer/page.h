// SPDX-License-Identifier: Apache-2.0
/// The page that the build made, around the data of one stream.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace tactus::cli {

/// The page with its own marker for the data.
std::string_view page_template() noexcept;

/// The data as text that ends no element of the page, whatever names it holds.
std::string page_json(const nlohmann::ordered_json& data);

/// Write the page around data from page_json().
void write_page(std::ostream& out, std::string_view data);
/// The page that asks the server at this port of this machine for its data, and may ask nobody else.
std::string live_page(std::uint16_t port);

}  // namespace tactus::cli
