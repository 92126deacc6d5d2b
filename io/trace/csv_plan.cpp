// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_plan.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/trace/csv.h>

namespace tactus {

// ==== csv plan ====

namespace {

template <class T, std::size_t N>
std::vector<std::string> all_columns(const std::string& path, const std::array<CsvColumn<T>, N>& columns) {
  std::vector<std::string> names;
  names.reserve(N);
  for (const auto& column : columns) names.push_back(path + column.name);
  return names;
}

/// Notes the first mistake and lets the caller go on, so that a plan reads as a list of what it wants; lists of foreign length stop.
class Planner {
 public:
  explicit Planner(const std::vector<std::string>& names) {
    plan_.names = names;
    used_.resize(names.size());
    for (std::size_t i = 0; i < plan_.names.size(); ++i)
      if (const auto [there, is_new] = columns_.emplace(plan_.names[i], i); !is_new) there->second = kTwice;
  }

  tl::expected<CsvPlan, Diagnostic> run() {
    plan_tactus();
    if (plan_.info.objects.empty() && plan_.info.users.empty()) note(Errc::invalid_argument, "R-CSV-8", "");
    if (mistake_) return tl::unexpected<Diagnostic>(*mistake_);
    return std::move(plan_);
  }

 private:
  void plan_tactus();
  void plan_tactus_object(const std::string& path);
  void plan_tactus_user(const std::string& path);
  void plan_forces(const std::string& path);
  template <std::size_t N>
  bool has_any(const std::string& path, const std::array<CsvColumn<UserSample>, N>& columns) const;
  template <std::size_t N>
  bool bind_sense(const std::string& path, const std::array<CsvColumn<UserSample>, N>& columns);
  std::optional<std::size_t> column_if_there(const std::string& name);
  void bind_object(std::span<const std::string> columns);
  void bind_user(std::span<const std::string> columns, std::span<const CsvColumn<UserSample>> fields);

  std::size_t column(const std::string& name) {
    const auto found = columns_.find(name);
    if (found != columns_.end() && found->second != kTwice) {
      used_[found->second] = true;
      return found->second;
    }
    note(Errc::malformed, "R-CSV-2", name);
    return 0;
  }
  void note(Errc code, RuleName rule, const std::string& name) {
    if (!mistake_) mistake_ = Diagnostic{.error = fail(code, rule).value(), .line = 1, .detail = location_of_field(name, "")};
  }

  static constexpr std::size_t kTwice = SIZE_MAX;
  CsvPlan plan_;
  std::map<std::string_view, std::size_t> columns_;  // by name
  std::vector<bool> used_;                           // per column
  std::optional<Diagnostic> mistake_;
};

void Planner::bind_object(std::span<const std::string> columns) {
  const auto object = static_cast<std::uint32_t>(plan_.info.objects.size() - 1);
  for (std::size_t i = 0; i < columns.size(); ++i)
    plan_.bindings.push_back({column(columns[i]), object, kObjectColumns[i].field, nullptr});
}

void Planner::bind_user(std::span<const std::string> columns, std::span<const CsvColumn<UserSample>> fields) {
  const auto user = static_cast<std::uint32_t>(plan_.info.users.size() - 1);
  for (std::size_t i = 0; i < columns.size(); ++i) plan_.bindings.push_back({column(columns[i]), user, nullptr, fields[i].field});
}

void Planner::plan_tactus() {
  plan_.tick = column("tick");
  plan_.time = column("time_s");
  plan_.shown = column_if_there(kShownColumn);
  plan_.info.shows_past = plan_.shown.has_value();
  for (const std::string& name : plan_.names) {
    if (mistake_) return;
    const std::size_t slash = name.rfind('/');
    if (slash == std::string::npos) continue;
    const std::string path = name.substr(0, slash + 1);
    const std::string_view last = std::string_view(name).substr(slash + 1);
    if (path.starts_with("/objects/") && last == kDofColumn) plan_tactus_object(path);
    if (path.starts_with("/users/") && last == kContactColumn) plan_tactus_user(path);
  }
  for (std::size_t i = 0; i < plan_.names.size(); ++i) {
    const std::string& name = plan_.names[i];
    if (!used_[i] && (name.starts_with("/objects/") || name.starts_with("/users/"))) note(Errc::malformed, "R-CSV-2", name);
  }
}

template <std::size_t N>
bool Planner::has_any(const std::string& path, const std::array<CsvColumn<UserSample>, N>& columns) const {
  return std::ranges::any_of(all_columns(path, columns), [&](const std::string& name) { return columns_.contains(name); });
}

/// What only some devices sense: all of its columns, or none.
template <std::size_t N>
bool Planner::bind_sense(const std::string& path, const std::array<CsvColumn<UserSample>, N>& columns) {
  if (!has_any(path, columns)) return false;
  bind_user(all_columns(path, columns), columns);
  return true;
}

/// One force at least, with all of its columns. The server's stands for the rendered one where that is not known.
void Planner::plan_forces(const std::string& path) {
  const bool has_server = has_any(path, kServerForceColumns), has_rendered = !has_server || has_any(path, kForceColumns);
  plan_.info.users.back().forces = !has_server    ? RecordedForces::rendered
                                   : has_rendered ? RecordedForces::both
                                                  : RecordedForces::server;
  bind_user(all_columns(path, has_rendered ? kForceColumns : kServerForceColumns), kForceColumns);
  if (has_server) bind_user(all_columns(path, kServerForceColumns), kServerForceColumns);
}

std::optional<std::size_t> Planner::column_if_there(const std::string& name) {
  return columns_.contains(name) ? std::optional(column(name)) : std::nullopt;
}

void Planner::plan_tactus_object(const std::string& path) {
  constexpr std::size_t kRoot = std::string_view("/objects/").size();
  plan_.info.objects.push_back({path.substr(kRoot, path.size() - kRoot - 1), Dof::all});
  plan_.dof.push_back(column(path + kDofColumn));
  bind_object(all_columns(path, kObjectColumns));
}

void Planner::plan_tactus_user(const std::string& path) {
  constexpr std::size_t kRoot = std::string_view("/users/").size();
  plan_.info.users.push_back({path.substr(kRoot, path.size() - kRoot - 1)});
  plan_.users.push_back({column(path + kContactColumn), column(path + kContactObjectColumn), {}, {}, {}, {}});
  bind_user(all_columns(path, kDeviceColumns), kDeviceColumns);
  plan_forces(path);
  bind_user(all_columns(path, kTouchColumns), kTouchColumns);
  CsvUserColumns& columns = plan_.users.back();
  columns.buttons = column_if_there(path + kButtonsColumn);
  columns.time = column_if_there(path + kDeviceTimeColumn);
  if (columns_.contains(path + kServoColumns[0])) {
    columns.servo.emplace();
    for (std::size_t i = 0; i < kServoColumns.size(); ++i) (*columns.servo)[i] = column(path + kServoColumns[i]);
  }
  columns.reports = column_if_there(path + kReportsColumn);
  if (columns.reports) plan_.info.users.back().report_descriptor.emplace();
  plan_.info.users.back().has_servo = columns.servo.has_value();
  plan_.info.users.back().senses = {.orientation = bind_sense(path, kOrientationColumns),
                                    .velocity = bind_sense(path, kDeviceVelocityColumns),
                                    .buttons = columns.buttons.has_value(),
                                    .time = columns.time.has_value()};
}

}  // namespace

std::string location_of_field(const std::string& column, const std::string& text) {
  std::string location = column.empty() ? "" : "column " + shown(column);
  if (!text.empty()) location += (location.empty() ? "'" : ", '") + shown(text) + '\'';
  return location;
}

tl::expected<CsvPlan, Diagnostic> plan_csv(const std::vector<std::string>& names) { return Planner(names).run(); }

// ==== csv presets ====

namespace {

CsvPreset tactus_preset() {
  CsvMapping mapping;
  mapping.layout = CsvLayout::tactus;
  return {"tactus", "what `export csv` writes: any objects and users", mapping};
}

CsvPreset cube_tosses_preset() {
  CsvMapping mapping;
  mapping.segment = "toss";
  mapping.position = {"x", "y", "z"};
  mapping.rotation = {"qw", "qx", "qy", "qz"};
  mapping.velocity = {"vx", "vy", "vz"};
  mapping.angular_velocity = {"wx", "wy", "wz"};
  mapping.angular_velocity_frame = AngularVelocityFrame::body;
  mapping.object = "cube";
  mapping.tick_rate = 148;
  return {"cube-tosses", "tosses of a cube (ContactNets, 148 Hz), lengths in metres", mapping};
}

CsvPreset kinaesthetic_preset() {
  CsvMapping mapping;
  mapping.position = {"robot_position_x", "robot_position_y", "robot_position_z"};
  mapping.device = {"human_position_x", "human_position_y", "human_position_z"};
  mapping.force = {"robot_force_x", "robot_force_y", "robot_force_z"};
  mapping.object = "robot";
  mapping.user = "human";
  mapping.tick_rate = 1000;
  return {"kinaesthetic", "a teleoperator and the hand that leads it (Kinaesthetic Interactions, 1 kHz)", mapping};
}

}  // namespace

const std::vector<CsvPreset>& csv_presets() {
  static const std::vector<CsvPreset> presets{tactus_preset(), cube_tosses_preset(), kinaesthetic_preset()};
  return presets;
}

}  // namespace tactus
