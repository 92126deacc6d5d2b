// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_named.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/trace/csv_fields.h>
#include <tactus/trace/csv_plan.h>
#include <tactus/trace/csv_units.h>

namespace tactus {
namespace {

/// Notes the first mistake and lets the caller go on, so that a plan reads as a list of what it wants.
class NamedPlanner {
 public:
  NamedPlanner(const CsvMapping& mapping, const CsvHeader& header) : mapping_(mapping), header_(header) {
    plan_.names = header.names;
    plan_.used.resize(header.names.size());
    plan_.notes = header.notes;
  }

  CsvResult<CsvNamedPlan> run();

 private:
  void plan_time();
  void plan_second_time(const std::string& name);
  void guess_fraction();
  void plan_subject(const CsvQuantities& q, const std::string& object, const std::string& user);
  void plan_rotation(const CsvQuantities& q, CsvChannel& channel);
  void plan_quaternion(std::array<std::string, 4> columns, CsvChannel& channel);
  void plan_euler(const CsvQuantities& q, CsvChannel& channel);
  template <std::size_t N>
  bool has_group(const std::array<std::string, N>& columns);
  std::vector<std::size_t> find(const std::string& name) const;
  std::size_t column(const std::string& name);
  CsvNumber number(const std::string& name, CsvDimension dimension);
  double scale_of(std::size_t column, CsvDimension dimension);
  std::string option_of(CsvDimension dimension) const;
  void mistake(Errc code, RuleName rule, const std::string& column, std::string remedy = {}) {
    if (!mistake_)
      mistake_ = Diagnostic{.error = fail(code, rule).value(),
                            .line = header_.line,
                            .detail = location_of_field(column, ""),
                            .remedy = std::move(remedy)};
  }

  const CsvMapping& mapping_;
  const CsvHeader& header_;
  CsvNamedPlan plan_;
  std::optional<Diagnostic> mistake_;
};

std::string lower(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
}

/// "Rigid Body cup 1 Position X" for "cup Position X": these words in this order, the last one at the end.
bool has_words(std::string_view column, std::string_view name) {
  std::vector<std::string> words, wanted;
  split_fields(column, kBlanks, words);
  split_fields(name, kBlanks, wanted);
  if (wanted.size() < 2 || words.back() != wanted.back()) return false;
  std::size_t next = 0;
  for (const std::string& word : words)
    if (next < wanted.size() && word == wanted[next]) ++next;
  return next == wanted.size();
}

/// All columns that may be meant; the first way of naming by which there is one counts.
std::vector<std::size_t> NamedPlanner::find(const std::string& name) const {
  const auto all = [&](auto is_meant) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < plan_.names.size(); ++i)
      if (is_meant(plan_.names[i])) found.push_back(i);
    return found;
  };
  if (auto found = all([&](const std::string& n) { return n == name; }); !found.empty()) return found;
  if (name.starts_with('#'))
    if (const auto number = parse_number<std::size_t>(name.substr(1)); number && *number >= 1 && *number <= plan_.names.size())
      return {*number - 1};
  if (auto found = all([&](const std::string& n) { return without_brackets(n) == name; }); !found.empty()) return found;
  if (auto found = all([&](const std::string& n) { return n.ends_with(' ' + name); }); !found.empty()) return found;
  return all([&](const std::string& n) { return has_words(n, name); });
}

std::size_t NamedPlanner::column(const std::string& name) {
  const auto found = find(name);
  if (found.size() == 1) {
    plan_.used[found[0]] = true;
    return found[0];
  }
  std::vector<std::string> words;  // of a line of "t:0 x:1", whatever stands between
  for (const std::string& n : plan_.names) {
    std::vector<std::string> own;
    split_fields(n, kBlanks, own);
    words.insert(words.end(), own.begin(), own.end());
  }
  const auto is_pair = [](const std::string& n) {
    const std::size_t mark = n.find_first_of(":=");
    return mark != std::string::npos && mark > 0 && std::isalpha(static_cast<unsigned char>(n[0])) != 0 &&
           is_value(n.substr(mark + 1));
  };
  if (found.empty() && std::ranges::all_of(words, is_pair)) {
    mistake(Errc::malformed, "R-CSV-2", name,
            "Fields are pairs of name and value: `sed -E 's/[A-Za-z_][A-Za-z_0-9]*[:=]//g' FILE >TABLE` leaves the values, whose "
            "columns are '#1', '#2', ...");
    return 0;
  }
  std::string remedy =
      found.empty() ? "The table has the columns "
                    : "Several columns are called so: name one by its number, such as #" + std::to_string(found[0] + 1) + ", of ";
  for (std::size_t i = 0; i < plan_.names.size() && i < 12; ++i) remedy += (i == 0 ? "" : ", ") + shown(plan_.names[i], 30);
  mistake(Errc::malformed, "R-CSV-2", name,
          remedy + (plan_.names.size() > 12 ? ", ..." : "") + "; --names and --skip-lines say where names are.");
  return 0;
}

/// All columns of a vector are named, or none.
template <std::size_t N>
bool NamedPlanner::has_group(const std::array<std::string, N>& columns) {
  const auto is_named = [](const std::string& name) { return !name.empty(); };
  const bool has_any = std::any_of(columns.begin(), columns.end(), is_named);
  if (has_any && !std::all_of(columns.begin(), columns.end(), is_named))
    mistake(Errc::invalid_argument, "R-CSV-8", *std::find_if(columns.begin(), columns.end(), is_named));
  return has_any;
}

std::string NamedPlanner::option_of(CsvDimension dimension) const {
  switch (dimension) {
    case CsvDimension::time:
      return mapping_.time_unit;
    case CsvDimension::angle:
      return mapping_.angle_unit;
    case CsvDimension::angular_speed:
      return mapping_.angle_unit.empty() ? "" : mapping_.angle_unit + "/s";
    case CsvDimension::force:
      return mapping_.force_unit;
    default:
      return {};
  }
}

/// SI units in one of the column: from its name, a line of units, the mapping; of two that differ none.
double NamedPlanner::scale_of(std::size_t column, CsvDimension dimension) {
  const std::string& name = plan_.names[column];
  UnitInName stated = unit_in_name(name, dimension);
  const char* source = "its name says";
  if (!stated.unit && !header_.units.empty() && !header_.units[column].empty()) {
    const auto unit = unit_of(header_.units[column]);
    if (unit && unit->dimension == dimension) stated = {unit, {}}, source = "the line of units says";
    else if (unit) stated.foreign = header_.units[column];
  }
  const bool is_length = dimension == CsvDimension::length;
  if (!stated.unit && is_length && !header_.length_unit.empty())
    if (const auto unit = unit_of(header_.length_unit); unit && unit->dimension == dimension)
      stated.unit = unit, source = "the lines ahead of the names say";
  const std::string option = option_of(dimension);
  double wanted = is_length || dimension == CsvDimension::speed ? mapping_.length_scale : 1;
  bool is_given = mapping_.says_length && (is_length || dimension == CsvDimension::speed);
  if (!option.empty()) {
    const auto unit = unit_of(option);
    if (!unit || unit->dimension != dimension)
      mistake(Errc::invalid_argument, "R-CSV-10", name, "'" + option + "' is no unit that is known.");
    else wanted = unit->scale;
    is_given = true;
  }
  if (stated.unit) {
    if (is_given && std::abs(wanted / stated.unit->scale - 1) > 1e-9)
      mistake(Errc::invalid_argument, "R-CSV-10", name,
              "It is " + std::string(stated.unit->name) + ", as " + source +
                  ": leave the option for its unit out, or correct the table.");
    if (!is_given && stated.unit->scale != 1)
      plan_.notes.add("column " + name, "in " + std::string(stated.unit->name) + ", as " + source);
    return stated.unit->scale;
  }
  if (!stated.foreign.empty() && !is_given) {
    if (unit_of(stated.foreign))
      mistake(Errc::invalid_argument, "R-CSV-10", name,
              "'" + shown(stated.foreign) + "' is a unit of another quantity: map another column, or rename it.");
    plan_.notes.add("column " + name, "'" + shown(stated.foreign) + "' is not taken for a unit");
  }
  return wanted;
}

CsvNumber NamedPlanner::number(const std::string& name, CsvDimension dimension) {
  if (name == kZeroColumn && std::ranges::find(plan_.names, name) == plan_.names.end()) return {};
  const std::size_t found = column(name);
  return {found, scale_of(found, dimension)};
}

void NamedPlanner::plan_time() {
  if (mapping_.time.empty()) return;
  std::vector<std::string> columns{mapping_.time};
  if (find(mapping_.time).empty()) split_fields(mapping_.time, ',', columns);
  if (columns.size() > 2) return mistake(Errc::malformed, "R-CSV-2", mapping_.time, "A time has one column, or two.");
  plan_.time = column(columns[0]);
  plan_.time_is_stated = !mapping_.time_unit.empty() || unit_in_name(plan_.names[*plan_.time], CsvDimension::time).unit ||
                         (!header_.units.empty() && unit_of(header_.units[*plan_.time]));
  if (mapping_.time_unit == kTickUnit) {
    if (mapping_.tick_rate == 0) return mistake(Errc::invalid_argument, "R-CSV-7", mapping_.time, "Give --tick-rate HZ.");
    plan_.time_unit = std::llround(1e9 / mapping_.tick_rate);
    return;
  }
  plan_.time_is_clock = mapping_.time_unit == kClockUnit;
  if (plan_.time_is_clock) return;
  plan_.time_unit = std::llround(1e9 * scale_of(*plan_.time, CsvDimension::time));
  if (columns.size() == 2) plan_second_time(columns[1]);
  else guess_fraction();
}

/// What stands beside a date or seconds.
void NamedPlanner::plan_second_time(const std::string& name) {
  const std::size_t second = column(name);
  auto unit = unit_in_name(plan_.names[second], CsvDimension::time).unit;
  if (!unit && !header_.units.empty())
    if (const auto stated = unit_of(header_.units[second]); stated && stated->dimension == CsvDimension::time) unit = stated;
  if (!unit) {
    plan_.clock = second;
    return;
  }
  plan_.fraction = second;
  plan_.fraction_unit = std::llround(1e9 * unit->scale);
  if (plan_.fraction_unit >= plan_.time_unit)
    mistake(Errc::invalid_argument, "R-CSV-10", name, "Name the column of seconds first, and then that of their fraction.");
}

/// "stamp.nanosec" beside "stamp.sec".
void NamedPlanner::guess_fraction() {
  const std::string_view name = plan_.names[*plan_.time];
  for (const std::string_view unit : {"seconds", "secs", "sec"}) {
    if (!name.ends_with(unit)) continue;
    const std::string_view stem = name.substr(0, name.size() - unit.size());
    for (std::size_t i = 0; i < plan_.names.size(); ++i) {
      if (i == *plan_.time || !plan_.names[i].starts_with(stem)) continue;
      const auto found = unit_of(std::string_view(plan_.names[i]).substr(stem.size()));
      if (!found || found->dimension != CsvDimension::time || found->scale >= 1) continue;
      plan_.fraction = i;
      plan_.fraction_unit = std::llround(1e9 * found->scale);
      plan_.fraction_is_guess = true;
      return;
    }
    return;
  }
}

void NamedPlanner::plan_quaternion(std::array<std::string, 4> columns, CsvChannel& channel) {
  constexpr std::string_view kListed[2]{"wxyz", "xyzw"};
  std::string by_name(4, ' ');
  std::size_t known = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto found = find(columns[i]);
    if (found.size() != 1) column(columns[i]);
    const char axis = found.size() == 1 ? axis_in_name(plan_.names[found[0]]) : static_cast<char>(0);
    if (axis != 0) by_name[i] = axis, ++known;
  }
  if (known == 3 && std::set<char>(by_name.begin(), by_name.end()).size() == 4) {  // the fourth is the one that is left
    for (const char axis : std::string_view("wxyz"))
      if (by_name.find(axis) == std::string::npos) by_name[by_name.find(' ')] = axis;
    known = 4;
  }
  const std::string_view option =
      mapping_.quaternion_order == QuaternionOrder::by_names ? "" : kListed[mapping_.quaternion_order == QuaternionOrder::xyzw];
  std::string_view order = option.empty() ? kListed[0] : option;
  const bool are_four = known == 4 && std::set<char>(by_name.begin(), by_name.end()).size() == 4;
  if (are_four && option.empty()) {
    if (by_name != order)
      plan_.notes.add("column " + columns[0], "rotations are in the order " + by_name + ", as the columns are called");
    order = by_name;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (by_name[i] != ' ' && by_name[i] != order[i])
      mistake(Errc::invalid_argument, "R-CSV-10", columns[i],
              "The name says " + std::string(1, by_name[i]) + " where the order " + std::string(order) + " has " + order[i] +
                  ": list the columns in that order, or give --quaternion-order.");
    channel.rotation[std::string_view("wxyz").find(order[i])] = {column(columns[i]), 1};
  }
  if (known != 0 || !option.empty()) return;
  channel.order = CsvChannel::Order::counted;
  for (std::size_t i = 0; i < 4; ++i)
    if (!plan_.names[*channel.rotation[i].column].ends_with(static_cast<char>('0' + i))) channel.order = CsvChannel::Order::open;
}

void NamedPlanner::plan_euler(const CsvQuantities& q, CsvChannel& channel) {
  const std::string order = lower(mapping_.euler_order);
  const bool is_order =
      order.size() == 3 && order.find_first_not_of("xyz") == std::string::npos && order[0] != order[1] && order[1] != order[2];
  if (!is_order)
    return mistake(Errc::invalid_argument, "R-CSV-10", q.euler[0],
                   "Give --euler-order ZYX (about turned axes) or xyz (about fixed ones), in the order of turning.");
  std::array<std::string, 3> columns = q.euler;
  if (order[0] != order[2]) {  // each axis once: names may show the order
    std::array<char, 3> axes{};
    for (std::size_t i = 0; i < 3; ++i)
      if (const auto found = find(columns[i]); found.size() == 1) axes[i] = axis_in_name(plan_.names[found[0]]);
    if (std::set<char>(axes.begin(), axes.end()) == std::set<char>{'x', 'y', 'z'})
      for (std::size_t i = 0; i < 3; ++i) columns[order.find(axes[i])] = q.euler[i];
    else
      plan_.notes.add("column " + columns[0],
                      "angles are taken in the order " + mapping_.euler_order + ": the columns are not called after axes");
  }
  const bool is_fixed = !mapping_.euler_order.empty() && std::islower(static_cast<unsigned char>(mapping_.euler_order[0])) != 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t to = is_fixed ? 2 - i : i;
    channel.euler_axes[to] = static_cast<std::uint8_t>(order[i] - 'x');
    if (columns[i] == kZeroColumn && find(columns[i]).empty()) continue;  // that angle is 0
    const std::size_t found = column(columns[i]);
    const bool is_stated = !mapping_.angle_unit.empty() || unit_in_name(plan_.names[found], CsvDimension::angle).unit ||
                           (!header_.units.empty() && unit_of(header_.units[found]));
    if (!is_stated)
      mistake(Errc::invalid_argument, "R-CSV-10", columns[i], "Say whether the angles are degrees: --angle-unit deg or rad.");
    channel.rotation[to] = {found, scale_of(found, CsvDimension::angle)};
  }
}

void NamedPlanner::plan_rotation(const CsvQuantities& q, CsvChannel& channel) {
  using Turn = CsvChannel::Turn;
  const bool has[4]{has_group(q.rotation), has_group(q.euler), has_group(q.rotation_vector), has_group(q.rotation_matrix)};
  if (std::count(std::begin(has), std::end(has), true) > 1)
    return mistake(Errc::invalid_argument, "R-CSV-8", "rotation",
                   "Map one of rotation, euler, rotation_vector and rotation_matrix.");
  if (has[0]) channel.turn = Turn::quaternion, plan_quaternion(q.rotation, channel);
  if (has[1]) channel.turn = Turn::euler, plan_euler(q, channel);
  if (has[2]) {
    channel.turn = Turn::vector;
    for (std::size_t i = 0; i < 3; ++i) channel.rotation[i] = number(q.rotation_vector[i], CsvDimension::angle);
  }
  if (has[3]) {
    channel.turn = Turn::matrix;
    for (std::size_t i = 0; i < 9; ++i) channel.rotation[i] = {column(q.rotation_matrix[i]), 1};
  }
}

void NamedPlanner::plan_subject(const CsvQuantities& q, const std::string& object, const std::string& user) {
  const auto vector_of = [&](const std::array<std::string, 3>& columns, CsvDimension dimension) {
    std::array<CsvNumber, 3> numbers;
    for (std::size_t i = 0; i < 3; ++i) numbers[i] = number(columns[i], dimension);
    return numbers;
  };
  const bool has_position = has_group(q.position), has_velocity = has_group(q.velocity),
             has_angular_velocity = has_group(q.angular_velocity);
  CsvChannel channel;
  plan_rotation(q, channel);
  const bool has_rotation = channel.turn != CsvChannel::Turn::none;
  if (has_position) {
    channel.index = static_cast<std::uint32_t>(plan_.info.objects.size());
    channel.position = vector_of(q.position, CsvDimension::length);
    channel.has_velocity = has_velocity;
    channel.has_angular_velocity = has_angular_velocity;
    if (has_velocity) channel.velocity = vector_of(q.velocity, CsvDimension::speed);
    if (has_angular_velocity) channel.angular_velocity = vector_of(q.angular_velocity, CsvDimension::angular_speed);
    plan_.info.objects.push_back({object, has_rotation || has_angular_velocity ? Dof::all : Dof::translation});
    plan_.channels.push_back(channel);
  } else if (has_rotation || has_velocity || has_angular_velocity) {
    mistake(Errc::invalid_argument, "R-CSV-8", "position",
            "Map the position of the object, too; where a table has none, --map position=0,0,0.");
  }
  if (has_angular_velocity && !has_rotation && mapping_.angular_velocity_frame == AngularVelocityFrame::body)
    mistake(Errc::invalid_argument, "R-CSV-8", "rotation");
  const bool has_device = has_group(q.device), has_force = has_group(q.force);
  CsvQuantities turn;  // of the device, by the same path
  turn.rotation = q.device_rotation, turn.euler = q.device_euler;
  turn.rotation_vector = q.device_rotation_vector, turn.rotation_matrix = q.device_rotation_matrix;
  CsvChannel device{.kind = CsvChannel::Kind::device};
  plan_rotation(turn, device);
  const bool has_hold = device.turn != CsvChannel::Turn::none;
  if (has_hold && !has_device)
    mistake(Errc::invalid_argument, "R-CSV-8", "device_rotation", "Map the position of the device, too.");
  if (!has_device && !has_force) return;
  const auto index = static_cast<std::uint32_t>(plan_.info.users.size());
  plan_.info.users.push_back({user});
  if (has_device) {
    device.index = index;
    device.position = vector_of(q.device, CsvDimension::length);
    plan_.info.users.back().senses.orientation = has_hold;
    plan_.channels.push_back(device);
  }
  if (has_force)
    plan_.channels.push_back(
        {.kind = CsvChannel::Kind::force, .index = index, .position = vector_of(q.force, CsvDimension::force)});
}

CsvResult<CsvNamedPlan> NamedPlanner::run() {
  plan_time();
  if (!mapping_.segment.empty()) plan_.segment = column(mapping_.segment);
  if (!mapping_.object_column.empty()) plan_.object = column(mapping_.object_column);
  if (plan_.object && !mapping_.others.empty())
    mistake(Errc::invalid_argument, "R-CSV-8", mapping_.object_column,
            "With --object-column, rows name the objects: --map takes none.");
  plan_subject(mapping_, mapping_.object, mapping_.user);
  for (const CsvSubject& other : mapping_.others) plan_subject(other, other.name, other.name);
  if (plan_.channels.empty()) mistake(Errc::invalid_argument, "R-CSV-8", "");
  if (mistake_) return tl::unexpected(*mistake_);
  return std::move(plan_);
}

}  // namespace

CsvResult<CsvNamedPlan> plan_named_csv(const CsvMapping& mapping, const CsvHeader& header) {
  return NamedPlanner(mapping, header).run();
}

}  // namespace tactus
