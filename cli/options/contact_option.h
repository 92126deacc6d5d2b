// SPDX-License-Identifier: Apache-2.0
/// --contact: what a user of a recording touched.
#pragma once

#include <string>
#include <vector>

#include <tactus/trace/declared_contact.h>

#include "cli/command.h"
#include "cli/report/report.h"

namespace tactus::cli {

class ContactArguments {
 public:
  void add_to(Command& command);
  std::vector<DeclaredContact> declared() const;
  /// err  there is no such user or object in the trace
  tl::expected<ContactDeclarations, Failure> of(const TraceInfo& info, const std::string& file) const;

 private:
  std::vector<std::string> typed_;
};

/// Say on standard error that -p was typed, but no force has a bound.
void note_idle_deadband(const Command& command, const Report& report);

}  // namespace tactus::cli
