// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/sim_check.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace tactus::cli {
namespace {

template <class T>
bool put(std::FILE* out, const T* values, std::size_t count) {
  return std::fwrite(values, sizeof(T), count, out) == count;
}

/// A signal that the command will look at between two ticks does not end it.
template <class T>
bool get(std::FILE* in, T* values, std::size_t count) {
  std::size_t done = 0;
  while (true) {
    done += std::fread(reinterpret_cast<char*>(values) + done, 1, count * sizeof(T) - done, in);
    if (done == count * sizeof(T)) return true;
    if (std::feof(in) || errno != EINTR) return false;
    std::clearerr(in);
  }
}

/// All that is compared, tick by tick, until the reader has enough.
bool write_run(const SimCheck::Step& step, std::FILE* out) {
  while (const CheckedTick* const now = step()) {
    const TraceFrame* const frame = now->frame;
    if (!put(out, now->energies.data(), now->energies.size()) || !put(out, now->works.data(), now->works.size())) return false;
    for (const RigidSample& object : frame->objects)
      if (!put(out, &object.pose, 1)) return false;
    for (const UserSample& user : frame->users)
      if (!put(out, &user.force, 1)) return false;
    for (const DeformableSample& mesh : frame->meshes)
      if (!put(out, &mesh.updated, 1) || (mesh.updated && !put(out, mesh.displacements.data(), mesh.displacements.size())))
        return false;
  }
  return std::fflush(out) == 0;
}

[[noreturn]] void run_child(int to, const std::function<SimCheck::Step()>& make) {
  // Who asked ends it, or has ended.
  for (const int number : {SIGPIPE, SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_IGN);
  std::FILE* const out = fdopen(to, "wb");
  const SimCheck::Step step = make();
  const bool done = out != nullptr && step && write_run(step, out);
  std::_Exit(done ? EXIT_SUCCESS : EXIT_FAILURE);
}

tl::unexpected<Failure> no_process() {
  return tl::unexpected(
      Failure{fmt::format("--check: no process for the finer run: {}", std::strerror(errno)), "Leave out --check."});
}

double largest_difference(std::span<const float> a, std::span<const float> b) {
  double out2 = 0;
  for (std::size_t i = 0; i + 2 < a.size(); i += 3) {
    const Vec3 d{double{a[i]} - double{b[i]}, double{a[i + 1]} - double{b[i + 1]}, double{a[i + 2]} - double{b[i + 2]}};
    out2 = std::max(out2, dot(d, d));
  }
  return std::sqrt(out2);
}

double largest(std::span<const float> a) { return largest_difference(a, std::vector<float>(a.size())); }

void look(EnergyDifference& energy, double own, double other, double first) {
  energy.largest = std::max(energy.largest, std::abs(own - other));
  energy.of = std::max(energy.of, std::abs(own - first));
  energy.square_sum += (own - other) * (own - other);
}

void look(CheckReport::Quantity& quantity, double difference, double size, double at) {
  quantity.of = std::max(quantity.of, size);
  quantity.square_sum += difference * difference;
  ++quantity.count;
  if (difference <= quantity.largest) return;
  quantity.largest = difference;
  quantity.at = at;
}

}  // namespace

void CheckedTick::end(const TraceFrame& of_tick) {
  frame = &of_tick;
  const std::size_t users = of_tick.users.size();
  const bool begins = works.empty();
  works.resize(users);
  forces_.resize(users);
  positions_.resize(users);
  for (std::size_t i = 0; i < users; ++i) {
    const UserSample& user = of_tick.users[i];
    if (!begins) works[i] -= dot(forces_[i], user.device.position - positions_[i]);
    positions_[i] = user.device.position;
    forces_[i] = user.force;
  }
}

SimCheck::SimCheck(const TraceInfo& info, std::string against) : tick_(1.0 / info.tick_rate) {
  report_.against = std::move(against);
  for (const TraceObject& object : info.objects) report_.objects.push_back({.name = object.name});
  for (const TraceUser& user : info.users) report_.users.push_back({.name = user.name});
  for (const TraceDeformable& mesh : info.meshes) {
    report_.meshes.push_back({.name = mesh.name});
    meshes_.emplace_back(3 * mesh.rest.vertices.size());
  }
  report_.turns.resize(info.objects.size());
}

tl::expected<SimCheck, Failure> SimCheck::start(const TraceInfo& info, std::string against, const std::function<Step()>& make) {
  SimCheck check(info, std::move(against));
  int ends[2];
  if (pipe(ends) != 0) return no_process();
  std::fflush(nullptr);
  check.child_ = fork();
  if (check.child_ < 0) return no_process();
  if (check.child_ == 0) {
    close(ends[0]);
    run_child(ends[1], make);
  }
  close(ends[1]);
  check.pipe_.reset(fdopen(ends[0], "rb"));
  return check;
}

/// A process whose reader has gone may wait for ever, as those started later have its pipe, too.
rusage SimCheck::end() noexcept {
  rusage used{};
  pipe_.reset();
  if (child_ <= 0) return used;
  kill(child_, SIGKILL);
  wait4(std::exchange(child_, -1), nullptr, 0, &used);
  return used;
}

SimCheck::~SimCheck() {
  if (pipe_) end();
}

Outcome SimCheck::add(const CheckedTick& of_own) {
  const TraceFrame& frame = *of_own.frame;
  const auto ended = [this] {
    return tl::unexpected(
        Failure{"--check: the run with " + report_.against + " ended early", "See its error above, or leave out --check."});
  };
  const double at = tick_ * static_cast<double>(frame.tick);
  std::vector<double> energies(of_own.energies.size()), works(of_own.works.size());
  if (!get(pipe_.get(), energies.data(), energies.size()) || !get(pipe_.get(), works.data(), works.size())) return ended();
  if (first_energies_.empty()) first_energies_ = of_own.energies;
  const auto compare_energy = [&](CheckReport::Quantity& quantity, std::size_t i) {
    if (!quantity.energy) quantity.energy.emplace();
    look(*quantity.energy, of_own.energies[i], energies[i], first_energies_[i]);
  };
  const std::size_t rigid = energies.size() - frame.meshes.size();
  if (starts_.empty())
    for (const RigidSample& object : frame.objects) starts_.push_back(object.pose.position);
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    Pose other;
    if (!get(pipe_.get(), &other, 1)) return ended();
    const Pose& own = frame.objects[i].pose;
    look(report_.objects[i], norm(own.position - other.position), norm(own.position - starts_[i]), at);
    report_.turns[i] = std::max(report_.turns[i], angle_between(own.rotation, other.rotation));
    if (i < rigid) compare_energy(report_.objects[i], i);
  }
  for (std::size_t i = 0; i < frame.users.size(); ++i) {
    Vec3 other;
    if (!get(pipe_.get(), &other, 1)) return ended();
    look(report_.users[i], norm(frame.users[i].force - other), norm(frame.users[i].force), at);
    if (!report_.users[i].energy) report_.users[i].energy.emplace();
    look(*report_.users[i].energy, of_own.works[i], works[i], 0);
  }
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    bool updated = false;
    if (!get(pipe_.get(), &updated, 1)) return ended();
    if (updated && !get(pipe_.get(), meshes_[i].data(), meshes_[i].size())) return ended();
    if (!frame.meshes[i].updated) continue;
    const std::vector<float>& own = frame.meshes[i].displacements;
    look(report_.meshes[i], largest_difference(own, meshes_[i]), largest(own), at);
    compare_energy(report_.meshes[i], rigid + i);
  }
  return {};
}

CheckReport SimCheck::finish() {
  const rusage used = end();
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  report_.cpu = seconds(used.ru_utime) + seconds(used.ru_stime);
  return std::move(report_);
}

}  // namespace tactus::cli
