// SPDX-License-Identifier: Apache-2.0
#include "cli/options/contact_option.h"

#include <fmt/format.h>

#include <algorithm>

#include <tactus/base/shown.h>
#include <tactus/base/text.h>

namespace tactus::cli {
namespace {

constexpr const char* kForm = "must be USER=OBJECT,k=STIFFNESS[,surface=plane|spring][,at=device|origin], as hand=cup,k=500N/m";

/// "500N/m", "0.5N/mm", "500".
double stiffness_of(const std::string& text) {
  double unit = 1;
  std::string number = text;
  for (const auto& [name, scale] : {std::pair<std::string, double>{"N/mm", 1e3}, {"N/m", 1}}) {
    if (!number.ends_with(name)) continue;
    number.resize(number.size() - name.size());
    unit = scale;
    break;
  }
  number.erase(number.find_last_not_of(' ') + 1);
  const auto value = parse_number<double>(number);
  return value && *value > 0 ? *value * unit : 0;
}

/// err  a sentence
tl::expected<DeclaredContact, std::string> parse(const std::string& typed) {
  const std::size_t equals = typed.find('='), comma = typed.find(',');
  if (equals == std::string::npos || comma == std::string::npos || equals == 0 || comma <= equals + 1)
    return tl::make_unexpected(fmt::format("'{}': {}", typed, kForm));
  DeclaredContact out{.user = typed.substr(0, equals), .object = typed.substr(equals + 1, comma - equals - 1)};
  for (std::size_t at = comma; at != std::string::npos;) {
    const std::size_t next = typed.find(',', at + 1);
    const std::string part = typed.substr(at + 1, next == std::string::npos ? next : next - at - 1);
    if (part.starts_with("k=")) out.stiffness = stiffness_of(part.substr(2));
    else if (part == "surface=plane") out.kind = ContactKind::surface;
    else if (part == "surface=spring") out.kind = ContactKind::spring;
    else if (part == "at=device") out.at = ForcePoint::device;
    else if (part == "at=origin") out.at = ForcePoint::origin;
    else return tl::make_unexpected(fmt::format("'{}': {}", typed, kForm));
    at = next;
  }
  if (!(out.stiffness > 0))
    return tl::make_unexpected(fmt::format("'{}': k is a stiffness above 0, as 500N/m or 0.5N/mm", typed));
  return out;
}

template <class List>
std::string names_of(const List& list) {
  std::string out;
  for (const auto& of : list) out += (out.empty() ? "" : ", ") + shown(of.name);
  return out.empty() ? "none" : out;
}

}  // namespace

void ContactArguments::add_to(Command& command) {
  command
      .add_option(
          "--contact", typed_,
          "What a user of a recording touches, USER=OBJECT,k=500N/m: gives its recorded forces a bound. The force stretches a "
          "spring of this stiffness between device and object; ,surface=plane (default) counts what lies along the force, "
          ",surface=spring (a grip) the whole vector; ,at=origin for a recording without device positions")
      ->type_name("USER=OBJECT,k=STIFFNESS")
      ->one_value()
      ->check([](const std::string& typed) {
        const auto parsed = parse(typed);
        return parsed ? std::string() : parsed.error();
      });
}

std::vector<DeclaredContact> ContactArguments::declared() const {
  std::vector<DeclaredContact> out;
  for (const std::string& typed : typed_) out.push_back(parse(typed).value());  // it was checked
  return out;
}

tl::expected<ContactDeclarations, Failure> ContactArguments::of(const TraceInfo& info, const std::string& file) const {
  const std::vector<DeclaredContact> declared = this->declared();
  for (const DeclaredContact& of : declared) {
    if (std::ranges::find(info.users, of.user, &TraceUser::name) == info.users.end())
      return refuse(fmt::format("{}: --contact: there is no user \"{}\"", shown_path(file), shown(of.user)),
                    fmt::format("Users of this trace: {}.", names_of(info.users)));
    if (info.objects.empty())
      return refuse(
          fmt::format("{}: --contact: there is no rigid object \"{}\", nor any other", shown_path(file), shown(of.object)),
          "Record or add the pose of what is touched; `tactus bench signals` codes forces alone.");
    if (std::ranges::find(info.objects, of.object, &TraceObject::name) == info.objects.end())
      return refuse(fmt::format("{}: --contact: there is no rigid object \"{}\"", shown_path(file), shown(of.object)),
                    fmt::format("Rigid objects of this trace: {}.", names_of(info.objects)));
  }
  auto out = ContactDeclarations::create(info, declared);
  if (!out) return refuse(shown_path(file) + ": --contact: a user is declared twice", "Give one --contact for each user.");
  return std::move(*out);
}

void note_idle_deadband(const Command& command, const Report& report) {
  const Option* typed = command.find("--deadband");
  if (typed != nullptr && typed->count() > 0 && !missing_force_bound(report).empty())
    fmt::print(stderr, "note: --deadband has no effect: this trace has forces and no contact\n");
}

}  // namespace tactus::cli
