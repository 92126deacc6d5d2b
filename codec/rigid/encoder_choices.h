// SPDX-License-Identifier: Apache-2.0
/// What the encoder of rigid objects chooses, and what it looks at for that: accelerations, forces that decay, the ratio of an error
/// to its bounds; from these the velocity it sends, how long an update is smoothed, and which predictor. A decoder reads the choices. Internal to the library.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/packet/held_list.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== contacts ====

/// The contacts of a tick that count: of those that a caller gave, the ones that break no rule, of objects that are not held.
class Contacts {
 public:
  /// What decides that.
  struct Filter {
    const Scene* scene = nullptr;
    const HeldList* held = nullptr;
    bool counts(const Contact& contact) const noexcept;
  };
  class Iterator {
   public:
    Iterator(const Contact* at, const Contact* end, const Filter* filter) noexcept : at_(at), end_(end), filter_(filter) {
      skip();
    }
    const Contact& operator*() const noexcept { return *at_; }
    Iterator& operator++() noexcept {
      ++at_;
      skip();
      return *this;
    }
    bool operator==(const Iterator& other) const noexcept { return at_ == other.at_; }

   private:
    void skip() noexcept {
      if (filter_ == nullptr) return;
      while (at_ != end_ && !filter_->counts(*at_)) ++at_;
    }
    const Contact* at_;
    const Contact* end_;
    const Filter* filter_;
  };

  Contacts() = default;
  /// in   filter  null: all count.   pre  both outlive this
  Contacts(std::span<const Contact> all, const Filter* filter) noexcept : all_(all), filter_(filter) {}
  template <std::convertible_to<std::span<const Contact>> All>
  Contacts(const All& all) noexcept : all_(all) {}
  Contacts(const Contact* all, std::size_t count) noexcept : all_(all, count) {}
  Iterator begin() const noexcept { return {all_.data(), all_.data() + all_.size(), filter_}; }
  Iterator end() const noexcept { return {all_.data() + all_.size(), all_.data() + all_.size(), nullptr}; }

 private:
  std::span<const Contact> all_;
  const Filter* filter_ = nullptr;
};

/// The rule that a contact breaks, R-API-1 or R-API-15, or none.   time about 10 ns
RuleName broken_rule(const Contact& contact, const Scene& scene) noexcept;

// ==== acceleration ====
// The acceleration of true motions, from the velocities of the last three ticks.

class Acceleration {
 public:
  /// A change of motion fades, a e^(-t/kFade): after t the truth has departed from a steady motion by a departure(t).
  static constexpr double kFade = 0.03;  ///< [s]
  static double departure(double seconds) noexcept;

  struct Motion {
    Vec3 linear, angular;  ///< per s, or per s^2
  };

  /// pre  `scene` outlives this
  explicit Acceleration(const Scene& scene);

  static constexpr std::size_t kKept = 3;  ///< ticks

  /// The truth of a tick, after those before it.   in   objects  those that have moved in the last kKept ticks
  /// time O(objects), no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const std::uint32_t> objects) noexcept;
  /// [m/s^2, rad/s^2] at the last read(). Zero in each component where the last two differences of the velocities do not agree.
  Motion of(std::uint32_t object) const noexcept;

 private:
  double seconds(std::size_t from, std::size_t to) const noexcept;

  const Scene& scene_;
  std::array<std::int64_t, kKept> ticks_;           // of the past, newest first
  std::array<std::vector<Motion>, kKept> motions_;  // by object
};

// ==== force trend ====
// How fast the forces on objects decay, and with them what may be wrong: an error that is inside its bound now may not be in a few
// milliseconds.

class ForceTrend {
 public:
  /// pre  `scene` outlives this.   allocates
  explicit ForceTrend(const Scene& scene);

  /// The contacts of a tick, after those before it.   time O(contacts), about 30 ns each; no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples, const Contacts& contacts) noexcept;
  /// [1/s] the part of the least force on the object that goes per second; 0 if it grows, or was not there two ticks ago
  double relative_decay_rate(std::uint32_t object) const noexcept;

 private:
  const Scene& scene_;
  std::array<std::int64_t, 3> ticks_{};                // of the past, newest first
  std::array<std::vector<double>, 3> forces_;          // [N] the least by object; infinite: nothing touches it
  std::array<std::vector<std::uint32_t>, 3> touched_;  // where they are finite
};

// ==== error ratio ====
// The ratio of a small error of an object's pose to its bounds, to first order: by it an encoder looks ahead. Internal to the
// library; the bounds themselves are checked without it.

class ErrorRatio {
 public:
  static constexpr std::size_t kMostContacts = 8;  ///< of the object; those after them are not looked at

  /// in  triggers  scaled;  truth  pose of the object;  decay_rate  ForceTrend, of all its contacts
  /// time O(contacts), about 30 ns for each of the object's
  ErrorRatio(std::uint32_t object, const Pose& truth, const Contacts& contacts, const RigidTriggers& triggers,
             double decay_rate = 0) noexcept;

  /// in   moved  [m], turned  [rad] from the true pose to the shown one, world frame;  later  [s] from now
  /// out  1: as large as is permitted then.   time about 20 ns
  double operator()(const Vec3& moved, const Vec3& turned, double later = 0) const noexcept;

 private:
  struct Touch {
    Vec3 lever;         // [m] from the object's origin to the point of contact, world frame
    Vec3 normal;        // zero: all directions count
    double depth;       // [m] of the probe below the face: what a tilt of the face turns
    double per_metre;   // ratio per metre of error at the point
    double least;       // what a force that decays leaves of what is permitted
    double per_radian;  // ratio per radian of the object
  };

  double per_metre_, per_radian_, decay_rate_;
  std::array<Touch, kMostContacts> touches_;
  std::size_t count_ = 0;
};

// ==== look-ahead velocity ====
// A velocity for an update that makes it last longer: it looks ahead along the acceleration, so that the error of the prediction first goes
// to one side of its bounds and then to the other. Informative: an encoder's choice; a decoder sees a velocity like any other.
//
//   v' = v + s a,  w' = w + s alpha                                    for all of one object the same s
//
// The truth is taken to go on with an acceleration that fades, a e^(-t/tau): it departs from v by a g(t),
// g(t) = tau (t - tau (1 - e^(-t/tau))), and the prediction departs from the truth by a (s t - g(t)). Its largest value on the one side is, with x = s/tau,
//   tau^2 ((1 - x) ln(1 - x) + x),  and shall be B = the smallest of permitted error over acceleration;
// x = y - y^2/6, at most 1, with y = sqrt(2 B)/tau, is within 7 % of that. For small B an update then lasts 1 + sqrt(2) times as long as
// with s = 0. What the truth really does decides how long it lasts, never whether a bound holds.

/// The velocities to send, less the true ones [m/s, rad/s].   time about 30 ns
Acceleration::Motion look_ahead_velocity(const Acceleration::Motion& acceleration, const ErrorRatio& ratio) noexcept;

// ==== smoothing choice ====
// How long an update of a smoothed scene may take to pass over to its own path. Informative: an encoder's choice.

/// An error of position [m] and rotation [rad], world frame, less than a right angle.
struct SmallError {
  Vec3 moved, turned;
};

/// What is known of an update's error in the ticks to come:
///   e(t) = offset (1 - t/T) + error + drift t - acceleration departure(t)
struct ErrorTrajectory {
  SmallError offset;                  ///< from the update's pose to the one shown when it comes: what is left to go
  SmallError error;                   ///< of the update's pose
  Acceleration::Motion drift;         ///< the velocities sent, less the true ones
  Acceleration::Motion acceleration;  ///< of the truth
};

/// `smoothing_exp`: the longest T = 2^smoothing_exp ticks, of at most 16 ms, during which the error stays inside its bounds; 0 if even two ticks are
/// too long.
/// time O(contacts), about 0.3 us with one
std::uint8_t longest_smoothing_exp(const ErrorTrajectory& trajectory, const ErrorRatio& ratio, std::uint32_t tick_rate) noexcept;

// ==== driven choice ====
// What an update would signal of the device that drives an object: where it touches, and the drag that explains how the object moved of late.
// spec/guide.md section 3. Informative: an encoder's choice, which no bound depends on.

class DevicePath;

class DrivenChoice {
 public:
  /// pre  `scene` and `path` outlive this, and the scene has driven objects.   allocates
  DrivenChoice(const Scene& scene, const DevicePath& path);

  /// Write what is signalled of each object; nothing where no device drives it, or one that is not that of the path.
  /// time O(moving objects + contacts), 0.1 us each; no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples, const Contacts& contacts,
            std::span<DrivenContact> signalled) noexcept;

 private:
  static constexpr std::size_t kWindow = 4;  // ticks over which the drag is looked at

  /// One tick of an object that is pushed.
  struct Moment {
    std::int64_t tick = -1;
    Vec3 velocity, angular;  // world and object frame
    Vec3 pull;               // acceleration by the device, world frame
    Vec3 arm;                // of the point that it acts on, world frame
  };

  const Contact* own_contact(std::uint32_t object, const Contacts& contacts, const Vec3i& device) const noexcept;
  double drag_of(std::uint32_t object, const RigidSample& now, const Vec3& rounding) const noexcept;

  const Scene& scene_;
  const DevicePath& path_;
  Vec3 gravity_;                 // [m/s^2]
  std::vector<Moment> moments_;  // kWindow + 1 per object, a ring by tick
};

// ==== predictor choice ====
// Which predictor an update chooses: the one that would have served longest of late. Each is started from true states of the last 150 ms
// and held against the truth of now, from the youngest start back until one would have left its bounds; the device's motion, which takes
// longer to compute, from where the best of the others would have left them, and not at all where it has in fact served for longer than
// that. What a device touches is predicted by it or linearly. Informative: an encoder's choice, which no bound depends on. Internal to the
// library.

/// The errors of a shown pose that end an update.
struct PermittedError {
  double position = 0;  ///< [m]
  double rotation = 0;  ///< [rad]
};

/// True states of the last 150 ms.
class PastStates {
 public:
  static constexpr std::size_t kKept = 32;

  /// pre  `scene` outlives this.   allocates 3 kB per object
  explicit PastStates(const Scene& scene);

  /// The truth of a tick, after those before it.
  /// in   moved  objects that are not what they were in the tick before;  signalled  of the device that drives them; empty: of none
  /// time O(objects that have moved of late), about 10 ns each, no allocation
  void read(std::int64_t tick, std::span<const RigidState> truth, std::span<const std::uint32_t> moved,
            std::span<const DrivenContact> signalled = {}) noexcept;
  /// The n-th youngest state that predictors are started from; nothing: there is none, or it says nothing of `now`.
  std::optional<RigidState> start(std::uint32_t object, std::int64_t now, std::size_t n) const noexcept;

 private:
  std::int64_t spacing_;    // [ticks] between states that are kept
  std::int64_t longest_;    // [ticks] older states say nothing of now
  std::size_t newest_ = 0;  // of the ring
  std::size_t count_ = 0;   // kept
  std::array<std::int64_t, kKept> ticks_{};
  std::vector<RigidState> states_;        // kKept per object; those of one that rests are alike
  std::vector<std::uint8_t> alike_;       // by object: the newest so many are, as it has not moved since
  std::vector<std::uint32_t> unsettled_;  // objects of which not all are alike
};

class PredictorChoice {
 public:
  /// in   past    where the device is known, with what is signalled of it;  device  as of RigidPredictor
  /// pre  all outlive this, and the scene has motion constants
  PredictorChoice(const Scene& scene, const PastStates& past, const DevicePath* device = nullptr)
      : scene_(scene), past_(past), predictor_(scene, device) {}

  /// in   truth       the object's state of now; where a device drives it, its contact is signalled
  /// in   is_touched  by a device, known or not;  current  the update that it replaces
  /// time < 2 us; where a device drives the object 0.1 us more for each tick of the path looked at, most often 50; no allocation
  Predictor choose(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, bool is_touched,
                   const RigidState& current) const noexcept;

 private:
  /// What a predictor would have done.
  struct Record {
    std::size_t served = 0;  // starts from which the error is within what is permitted
    double error = 0;        // sum over them
  };

  double error_of(Predictor predictor, std::uint32_t object, RigidState from, const RigidState& truth,
                  const PermittedError& permitted) const noexcept;
  Record record_of(Predictor predictor, std::uint32_t object, const RigidState& truth,
                   const PermittedError& permitted) const noexcept;
  /// Whether the device has driven the object for longer than a linear motion would have served.
  bool drives_on(std::uint32_t object, const RigidState& truth, const PermittedError& permitted,
                 const RigidState& current) const noexcept;
  /// Whether the device explains more than the best of the others, from the first start on that this one does not serve.
  bool is_driven(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, Predictor other,
                 std::size_t served) const noexcept;

  const Scene& scene_;
  const PastStates& past_;
  RigidPredictor predictor_;
};

}  // namespace tactus
