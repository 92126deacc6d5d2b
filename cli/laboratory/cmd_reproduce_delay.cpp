// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactus/sim/transparency/deformable_transparency.h>
#include <tactus/sim/transparency/pressing.h>
#include <tactus/sim/transparency/rigid_transparency.h>
#include "cli/laboratory/delay_figure.h"

namespace tactus::cli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWeber = 0.1;                           // c
constexpr double kFrequency = 0.5;                       // [Hz] of the hand
constexpr std::array kDelays{0.0, 0.037, 0.075, 0.150};  // [s] round trips of figures 4.20 and 4.22

double decibels(std::complex<double> value) { return 20 * std::log10(std::abs(value)); }
double percent_over(double value, double reference) { return 100 * (value / reference - 1); }

std::vector<double> milliseconds(std::span<const double> seconds) {
  std::vector<double> out;
  for (const double s : seconds) out.push_back(1e3 * s);
  return out;
}

/// 0.1 to 10 Hz.
std::vector<double> frequencies() {
  std::vector<double> out;
  for (int i = 0; i <= 200; ++i) out.push_back(std::pow(10.0, -1 + 0.01 * i));
  return out;
}

/// The cube of thesis 4.2.4.2 against viscous friction, one user.
struct Push {
  static constexpr double kMass = 0.25, kStiffness = 700;  // [kg], [N/m]
  /// [N s/m] with which equation 4.31 tells the 18 ms of figure 4.6; the thesis does not name it.
  static constexpr double kFriction = 126;

  static sim::RigidCoupling coupling(double round_trip, double client_stiffness) {
    return {.mass = kMass,
            .damping = kFriction,
            .client_stiffness = client_stiffness,
            .server_stiffness = kStiffness,
            .forward = round_trip / 2,
            .backward = round_trip / 2};
  }
  static double reduced(double round_trip) {
    return sim::reduced_stiffness({.velocity = 1, .damping = kFriction}, kStiffness, round_trip);
  }
};

/// Client impedance of a pushed object over frequency.
DelayFigure rigid_impedance() {
  constexpr std::array kRoundTrips{0.0, 0.018, 0.050, 0.100};  // [s]
  DelayFigure out{
      .figure = "fig4.7",
      .title = fmt::format("impedance at a client that pushes a rigid object of {} kg against viscous friction ({} N s/m)",
                           Push::kMass, Push::kFriction)};
  out.plot = {.name = "fig4.7", .program = "delay-rigid-figure-4.7", .width = 900, .height = 460};
  out.plot.set("delays", milliseconds(kRoundTrips));
  PlotData curves{"client", {}};
  out.table = "round_trip_ms,frequency_Hz,without_dB,with_dB\n";
  for (const double r : kRoundTrips) {
    for (const double f : frequencies()) {
      const auto at = [&](double k) {
        return decibels(sim::force_by_velocity(Push::coupling(r, k), 2 * kPi * f, sim::DelayModel::exact));
      };
      const double without = at(Push::kStiffness), with = at(Push::reduced(r));
      curves.rows.push_back({f, without, with});
      out.table += fmt::format("{:g},{:.6g},{:.6g},{:.6g}\n", 1e3 * r, f, without, with);
    }
    curves.rows.insert(curves.rows.end(), 2, {});
    const auto steady = [&](double k) {
      return std::abs(sim::force_by_velocity(Push::coupling(r, k), 1e-6, sim::DelayModel::exact));
    };
    if (r == 0) continue;
    out.compare(fmt::format("{:g} ms, slow motion, over zero delay", 1e3 * r), "%",
                percent_over(steady(Push::kStiffness), Push::kFriction), r == 0.018 ? std::optional(10.0) : std::nullopt);
    out.compare(fmt::format("{:g} ms with compensation, {:.0f} N/m", 1e3 * r, Push::reduced(r)), "%",
                percent_over(steady(Push::reduced(r)), Push::kFriction), 0.0);
  }
  out.plot.data = {std::move(curves)};
  return out;
}

/// The object of figures 4.18 to 4.24.
sim::DeformableCoupling pressed(double client_stiffness = 340) {
  return {.object_stiffness = 100,
          .object_damping = 2,
          .object_mass = 0.1,
          .client_stiffness = client_stiffness,
          .client_damping = 5,
          .server_stiffness = 340};
}

/// Impedances over frequency, with the client stiffness that belongs to each round trip.
DelayFigure deformable_impedance(const char* figure, double (*client_stiffness)(double round_trip)) {
  DelayFigure out{.figure = figure, .title = {}};
  out.plot = {.name = figure, .program = "delay-deformable-figure-4.20", .width = 900, .height = 480};
  out.plot.set("delays", milliseconds(kDelays));
  PlotData client{"client", {}}, server{"server", {}};
  out.table = "round_trip_ms,frequency_Hz,client_dB,approximated_dB,server_dB\n";
  for (const double r : kDelays) {
    const sim::DeformableCoupling coupling = pressed(client_stiffness(r));
    for (const double f : frequencies()) {
      const double omega = 2 * kPi * f;
      const double exact = decibels(sim::client_impedance(coupling, omega, r));
      const double slow = decibels(sim::slow_client_impedance(coupling, omega, r));
      const double reference = decibels(sim::server_impedance(coupling, omega));
      client.rows.push_back({f, exact, slow});
      if (r == 0) server.rows.push_back({f, reference});
      out.table += fmt::format("{:g},{:.6g},{:.6g},{:.6g},{:.6g}\n", 1e3 * r, f, exact, slow, reference);
    }
    client.rows.insert(client.rows.end(), 2, {});
  }
  out.plot.data = {std::move(client), std::move(server)};
  return out;
}

double error_at(double round_trip, double client_stiffness) {
  const double omega = 2 * kPi * kFrequency;
  const sim::DeformableCoupling coupling = pressed(client_stiffness);
  return percent_over(std::abs(sim::client_impedance(coupling, omega, round_trip)),
                      std::abs(sim::server_impedance(coupling, omega)));
}

double same_stiffness(double) { return 340; }
double stiffness_of_4_47(double round_trip) {
  return round_trip == 0 ? 340 : sim::reduced_stiffness_undamped(pressed(), 2 * kPi * kFrequency, round_trip);
}

DelayFigure without_compensation() {
  DelayFigure out = deformable_impedance("fig4.20", same_stiffness);
  out.title = "impedance of a deformable object at a client, k_o 100 N/m, k 340 N/m, b_c 5 N s/m";
  const double omega = 2 * kPi * kFrequency;
  struct Tolerable {
    double frequency;              // [Hz]
    std::optional<double> thesis;  // [ms]; that at 1 Hz stands in 4.3.4.2
  };
  for (const auto& [f, thesis] : {Tolerable{0.5, 37.5}, Tolerable{1, 19}, Tolerable{2, {}}}) {
    const auto delay = sim::tolerable_delay(pressed(), 2 * kPi * f, kWeber);
    out.compare(fmt::format("tolerable round trip at {:g} Hz, c = 10 % (eq. 4.45)", f), "ms", 1e3 * delay.value_or(0), thesis);
  }
  const double slow = decibels(sim::slow_client_impedance(pressed(), omega, 0.037)) -
                      decibels(sim::slow_client_impedance({100, 2, 0.1, 340, 0, 340}, omega, 0));
  out.compare("37 ms at 0.5 Hz, over the server, with K_i for K_i(s) (fig. 4.20b)", "dB", slow, 0.82);
  out.compare("37 ms at 0.5 Hz, over the server", "%", error_at(0.037, 340));
  out.compare("75 ms at 0.5 Hz, over the server", "%", error_at(0.075, 340), 39.6);
  return out;
}

DelayFigure with_compensation() {
  DelayFigure out = deformable_impedance("fig4.22", stiffness_of_4_47);
  out.title = "the same with the client stiffness reduced for 0.5 Hz";
  const double omega = 2 * kPi * kFrequency;
  const auto error = [](double round_trip) { return error_at(round_trip, stiffness_of_4_47(round_trip)); };
  out.compare("stiffness for 75 ms (eq. 4.47)", "N/m", stiffness_of_4_47(0.075));
  out.compare("75 ms at 0.5 Hz, over the server (eq. 4.47)", "%", error(0.075), 3.2);
  out.compare("75 ms at 0.5 Hz, over the server (eq. 4.46)", "%",
              error_at(0.075, sim::reduced_stiffness(pressed(), omega, 0.075)), 3.0);
  out.compare("37 ms at 0.5 Hz, over the server (eq. 4.47)", "%", error(0.037));
  out.compare("150 ms at 0.5 Hz, over the server (eq. 4.47)", "%", error(0.150));
  return out;
}

sim::Pressing pressing_of(std::vector<sim::PressingUser> users, double duration) {
  return {.object = {.stiffness = 100, .damping = 2, .mass = 0.1},
          .stiffness = 340,
          .client_damping = 5,
          .frequency = kFrequency,
          .duration = duration,
          .users = std::move(users)};
}

sim::PressingUser user_with(std::vector<sim::Press> presses, std::uint32_t round_trip) {
  return {std::move(presses), round_trip / 2, round_trip - round_trip / 2};
}

double peak(std::span<const double> force) { return *std::ranges::max_element(force); }

/// [%] of the ticks in contact in which the force is further than c from the reference of the same tick.
double share_felt(std::span<const double> force, std::span<const double> reference) {
  std::size_t over = 0, contact = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] == 0 && reference[i] == 0) continue;
    ++contact;
    over += std::abs(force[i] - reference[i]) > kWeber * reference[i] ? 1U : 0U;
  }
  return contact == 0 ? 0 : 100 * static_cast<double>(over) / static_cast<double>(contact);
}

/// Presses, holds and lets go, at several round trips.
tl::expected<DelayFigure, Failure> one_press() {
  constexpr std::array kRoundTrips{0U, 37U, 75U, 150U};  // [ms]
  const std::vector<sim::Press> presses{{0.2, 0.7, 2, 0.03}};
  DelayFigure out{.figure = "fig4.21", .title = "a user presses at 0.5 Hz, holds still and lets go"};
  out.plot = {.name = "fig4.21", .program = "delay-press-figure-4.21", .width = 900, .height = 460};
  std::vector<std::vector<double>> clients;
  std::vector<double> reference, names;
  for (const std::uint32_t r : kRoundTrips) {
    const auto felt = sim::press(pressing_of({user_with(presses, r)}, 2.8));
    if (!felt) return refuse(out.figure, felt.error());
    if (r == 0) reference = felt->front().server;
    clients.push_back(felt->front().client);
    names.push_back(r);
    if (r == 0) continue;
    out.compare(fmt::format("{} ms: peak of the force over that of the server", r), "%",
                percent_over(peak(clients.back()), peak(reference)), r == 37 ? std::optional(10.0) : std::nullopt);
  }
  out.plot.set("delays", names);
  PlotData data{"forces", {}};
  out.table = "time_s,server_N,client_0ms_N,client_37ms_N,client_75ms_N,client_150ms_N\n";
  for (std::size_t i = 0; i < reference.size(); ++i) {
    data.rows.push_back({1e-3 * static_cast<double>(i), reference[i]});
    for (const auto& client : clients) data.rows.back().push_back(client[i]);
    out.table += fmt::format("{:.3f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", 1e-3 * static_cast<double>(i), reference[i],
                             clients[0][i], clients[1][i], clients[2][i], clients[3][i]);
  }
  out.plot.data = {std::move(data)};
  return out;
}

constexpr std::size_t kDrawn = 4;  // every so many ticks, which no eye tells from all

/// Two users at the object of figure 4.18.
constexpr std::array kTwoRoundTrips{80U, 60U};  // [ms]

const std::array<std::vector<sim::Press>, 2>& both_presses() {
  static const std::array<std::vector<sim::Press>, 2> presses{std::vector<sim::Press>{{0.5, 1, 4, 0.03}, {5.5, 6, 7.5, 0.03}},
                                                              std::vector<sim::Press>{{2, 2.5, 6.8, 0.03}}};
  return presses;
}

tactus::Result<std::vector<sim::Felt>> press_both(bool delays, std::optional<double> lambda) {
  std::vector<sim::PressingUser> users;
  for (std::size_t i = 0; i < 2; ++i) users.push_back(user_with(both_presses()[i], delays ? kTwoRoundTrips[i] : 0));
  sim::Pressing pressing = pressing_of(std::move(users), 8.5);
  pressing.compensation = lambda;
  return sim::press(pressing);
}

/// What one of them feels for a while.
struct While {
  const char* name;
  std::size_t user, begin, end;  // [ms]
};
constexpr std::array kWhiles{While{"user 1 presses alone", 0, 500, 1900}, While{"user 2 presses beside user 1", 1, 2000, 3900},
                             While{"user 1 presses beside user 2", 0, 5500, 6700}, While{"user 1 only holds", 0, 2000, 3900}};

tl::expected<DelayFigure, Failure> two_users() {
  const auto reference = press_both(false, {});
  const std::array runs{press_both(true, {}), press_both(true, 0.01), press_both(true, 0.1)};
  DelayFigure out{.figure = "fig4.24", .title = "two users press the same object, round trips 80 ms and 60 ms"};
  for (const auto& run : {reference, runs[0], runs[1], runs[2]})
    if (!run) return refuse(out.figure, run.error());
  out.columns = {"without", "lambda 0.01", "lambda 0.1"};
  for (const auto& [name, user, begin, end] : kWhiles) {
    const auto part = [begin = begin, end = end](const std::vector<double>& force) {
      return std::span(force).subspan(begin, end - begin);
    };
    const auto server = part((*reference)[user].server);
    FigureNumber over{fmt::format("{}: peak over that of the server", name), "%", {}};
    FigureNumber outside{fmt::format("{}: time outside +-10 %", name), "%", {}};
    for (const auto& run : runs) {
      const auto client = part((*run)[user].client);
      over.values.emplace_back(percent_over(peak(client), peak(server)));
      outside.values.emplace_back(share_felt(client, server));
    }
    out.quantities.insert(out.quantities.end(), {std::move(over), std::move(outside)});
  }
  out.plot = {.name = "fig4.24", .program = "delay-press-figure-4.24", .width = 900, .height = 640};
  PlotData data{"forces", {}};
  out.table =
      "time_s,server_1_N,without_1_N,lambda_0.01_1_N,lambda_0.1_1_N,server_2_N,without_2_N,lambda_0.01_2_N,lambda_0.1_2_N\n";
  for (std::size_t i = 0; i < (*reference)[0].client.size(); ++i) {
    std::vector<double> row{1e-3 * static_cast<double>(i)};
    for (std::size_t user = 0; user < 2; ++user) {
      row.push_back((*reference)[user].server[i]);
      for (const auto& run : runs) row.push_back((*run)[user].client[i]);
    }
    out.table += fmt::format("{:.6g}\n", fmt::join(row, ","));
    if (i % kDrawn == 0) data.rows.push_back(std::move(row));
  }
  out.plot.data = {std::move(data)};
  return out;
}

/// What delay alone does to two users at one object.
tl::expected<DelayFigure, Failure> two_users_delayed() {
  const auto reference = press_both(false, {}), delayed = press_both(true, {});
  DelayFigure out{.figure = "fig4.18",
                  .title = "two users press the same object, round trips 80 ms and 60 ms, without compensation"};
  if (!reference || !delayed) return refuse(out.figure, (reference ? delayed : reference).error());
  out.columns = {"delayed"};
  for (const auto& [name, user, begin, end] : kWhiles) {
    const auto part = [begin = begin, end = end](const std::vector<double>& force) {
      return std::span(force).subspan(begin, end - begin);
    };
    out.quantities.push_back({fmt::format("{}: peak over that without delay", name),
                              "%",
                              {percent_over(peak(part((*delayed)[user].client)), peak(part((*reference)[user].client)))}});
  }
  out.plot = {.name = "fig4.18", .program = "delay-press-figure-4.18", .width = 900, .height = 760};
  PlotData data{"forces", {}};
  out.table = "time_s,device_1_mm,device_2_mm,no_delay_1_N,delayed_1_N,no_delay_2_N,delayed_2_N\n";
  for (std::size_t i = 0; i < (*reference)[0].client.size(); ++i) {
    const double time = 1e-3 * static_cast<double>(i);
    std::vector<double> row{time};
    for (const auto& presses : both_presses()) row.push_back(1e3 * std::max(0.0, sim::depth_of(presses, time, kFrequency)));
    for (std::size_t user = 0; user < 2; ++user)
      row.insert(row.end(), {(*reference)[user].client[i], (*delayed)[user].client[i]});
    out.table += fmt::format("{:.6g}\n", fmt::join(row, ","));
    if (i % kDrawn == 0) data.rows.push_back(std::move(row));
  }
  out.plot.data = {std::move(data)};
  return out;
}

}  // namespace

Outcome reproduce_delay(const ReproduceOptions& options) {
  if (options.figure == "fig4.7") return finish(options, rigid_impedance());
  if (options.figure == "fig4.20") return finish(options, without_compensation());
  if (options.figure == "fig4.22") return finish(options, with_compensation());
  if (options.figure == "fig4.18") {
    TACTUS_TRY(const DelayFigure delayed, two_users_delayed());
    return finish(options, delayed);
  }
  TACTUS_TRY(const DelayFigure result, options.figure == "fig4.21" ? one_press() : two_users());
  return finish(options, result);
}

}  // namespace tactus::cli
