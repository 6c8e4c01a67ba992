// One hour of a vehicle's life on a fake clock: every fault that is logic, one after the other,
// from frames with stamps to messages, alerts and log lines. Devices, processes and disks fail
// elsewhere (tests/vm, daemon_test).
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <set>

#include "locd/frames/set_pacer.h"
#include "locd/frames/stamp_guard.h"
#include "locd/pose/localizer.h"
#include "locd/publish/status_report.h"
#include "locd/publish/telemetry.h"
#include "locd/service/log_limiter.h"
#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using test::RoomDrive;

constexpr Stamp kPeriod = milliseconds(100);
constexpr Stamp kStart = hours(2);
constexpr std::size_t kCameras = 3;

test::RoomOptions room_options() {
  test::RoomOptions options;
  options.frame_sets = 300;
  options.noise_px = 0.1;
  options.state_covariances = true;
  return options;
}

/// What is wrong at the moment; the script turns it on and off.
struct Faults {
  std::array<bool, kCameras> gone{};
  std::array<Stamp, kCameras> stamps_off{};
  std::optional<std::pair<int, int>> exchanged;  ///< two markers hang in each other's place
  bool misread = false;                          ///< every tenth detection has another id
  Stamp solving = milliseconds(20);              ///< what a set takes
};

/// A vehicle with three cameras going to and fro in a room, all clocks under our hand.
class FaultHour : public testing::Test {
 protected:
  FaultHour()
      : drive_(test::make_room(room_options())),
        localizer_(std::make_unique<Localizer>(drive_.room().rig, map(), LocalizerOptions{})),
        telemetry_(lcm(), session(), clocks()),
        synchronizer_(kCameras, {}),
        report_(drive_.room().rig) {
    telemetry_.lcm()->subscribe("WAYMARK_POSE", &FaultHour::take_pose, this);
  }

  [[nodiscard]] MarkerMap map() { return test::room_map(drive_.room()); }
  static LcmOptions lcm() {
    LcmOptions lcm;
    lcm.url = "memq://";
    return lcm;
  }
  static SessionFacts session() {
    SessionFacts facts;
    facts.session_id = "0123456789abcdef";
    facts.map_hash = "fedcba9876543210";
    facts.cameras = kCameras;
    return facts;
  }
  [[nodiscard]] ClockReading clocks() const { return {now_, now_ + slept_, now_ + wall_ahead_}; }

  /// A tenth of a second: a set's frames, or what of them comes.
  void step() {
    now_ += kPeriod;
    if (telemetry_.follow_clocks(clocks()) != ClockEvent::none) log("TIME");
    const std::int64_t utime_us = telemetry_.utime_us(now_);
    if (steps_ > 0) {
      const auto passed_us = std::chrono::duration_cast<std::chrono::microseconds>(kPeriod).count();
      most_bent_us_ = std::max(most_bent_us_, std::abs(utime_us - last_utime_us_ - passed_us));
    }
    last_utime_us_ = utime_us;
    const std::size_t place = to_and_fro();
    FrameSetLease frames = drive_.set(place);
    for (std::size_t c = 0; c < kCameras; ++c) {
      if (!faults_.gone[c] && frames.has(c)) deliver(c, *frames.frames[c].detections());
    }
    const Stamp late = now_ + milliseconds(30);  // beyond the deadline: partial sets go, too
    while (auto set = synchronizer_.take(late)) localize(*set, place);
    telemetry_.keep_alive(now_ + kPeriod - milliseconds(1), PoseReason::no_frames);
    look_at_cameras();
    if (auto summary = limiter_.summary(now_)) ++log_lines_;
    while (telemetry_.lcm()->handleTimeout(0) > 0) continue;
    ++steps_;
  }
  void run(Stamp time) {
    for (const Stamp end = now_ + time; now_ < end;) step();
  }

  void restart_localizer() {
    localizer_ = std::make_unique<Localizer>(drive_.room().rig, map(), LocalizerOptions{});
  }

  [[nodiscard]] bool alerted(const std::string& what) const { return alerts_.contains(what); }

  Faults faults_;
  Stamp now_ = kStart;
  Stamp slept_{0};
  Stamp wall_ahead_ = seconds(1'800'000'000);
  std::array<int, 4> by_status_{};  ///< since the test looked last
  ReasonBits reasons_ = 0;          ///< likewise, of all poses
  int published_ = 0;
  int wrong_ok_ = 0;  ///< OK, but elsewhere
  Stamp longest_silence_{0};
  std::int64_t most_bent_us_ = 0;  ///< a period, as utime tells it
  int log_lines_ = 0;
  std::set<std::string> alerts_;
  SetPacer pacer_;

  void forget() {
    by_status_ = {};
    reasons_ = 0;
    published_ = 0;
    alerts_.clear();
  }

 private:
  [[nodiscard]] std::size_t to_and_fro() const {
    const std::size_t last = drive_.size() - 1;
    const std::size_t phase = steps_ % (2 * last);
    return phase <= last ? phase : 2 * last - phase;
  }

  void deliver(std::size_t camera, const ImageDetections& seen) {
    ImageDetections& image = images_[camera][steps_ % 4];
    image = seen;
    for (std::size_t i = 0; i < image.detections.size(); ++i) {
      // No two images are alike, though the drive goes to and fro.
      image.detections[i].corners[0].x() += 1e-9 * static_cast<double>(steps_);
      int& number = image.detections[i].marker.number;
      if (faults_.exchanged) {
        const auto [a, b] = *faults_.exchanged;
        number = number == a ? b : number == b ? a : number;
      }
      if (faults_.misread && (steps_ + i) % 10 == 0) number = (number + 17) % 30;
    }
    FrameInfo info;
    info.stamp = now_ - milliseconds(20) + faults_.stamps_off[camera];
    info.arrival = now_;
    Frame frame(info, {}, &image, nullptr, 0);
    ++states_[camera].frames;
    states_[camera].last_frame = now_;
    const bool admitted = guards_[camera].admit(frame, now_);
    states_[camera].unsynced = guards_[camera].unsynced();
    if (admitted) synchronizer_.push(camera, std::move(frame), now_);
  }

  void localize(const FrameSetLease& set, std::size_t place) {
    if (!pacer_.admit(set.mean_stamp())) return;
    localizer_->localize(set, estimate_);
    pacer_.finished(faults_.solving);
    telemetry_.publish_pose(estimate_, now_ + faults_.solving);
    for (const Alert& alert : localizer_->alerts()) raise(alert);
    if (estimate_.status != PoseStatus::ok) return;
    const Vector6d off = estimate_.world_from_rig.minus(drive_.room().world_from_rig[place]);
    if (off.head<3>().norm() > 0.02 || off.tail<3>().norm() > 0.0087) ++wrong_ok_;
  }

  void look_at_cameras() {
    report_.judge(states_, now_);
    for (const Alert& alert : report_.camera_alerts(states_, now_, seconds(2))) raise(alert);
  }

  void raise(const Alert& alert) {
    const std::string text = alert_text(alert, drive_.room().rig, false);
    alerts_.insert(text.substr(0, text.find_first_of(":;")));
    telemetry_.publish_alert(alert, drive_.room().rig, {}, now_);
    log(log_key(alert, drive_.room().rig, false));
  }
  void log(const std::string& what) { log_lines_ += limiter_.admit(what, now_) ? 1 : 0; }

  void take_pose(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                 const pose_t* pose) {
    ++published_;
    ++by_status_[static_cast<std::size_t>(pose->status)];
    reasons_ |= static_cast<ReasonBits>(pose->reasons);
    EXPECT_EQ(pose->status == pose_t::LOST, std::isnan(pose->position[0]));
    if (last_published_ > Stamp{0}) {
      longest_silence_ = std::max(longest_silence_, now_ - last_published_);
    }
    last_published_ = now_;
  }

  RoomDrive drive_;
  std::unique_ptr<Localizer> localizer_;
  Telemetry telemetry_;
  FrameSynchronizer synchronizer_;
  StatusReport report_;
  std::array<StampGuard, kCameras> guards_;
  std::vector<RigCapture::CameraState> states_{kCameras};
  std::array<std::array<ImageDetections, 4>, kCameras> images_;
  LogLimiter limiter_;
  PoseEstimate estimate_;
  std::size_t steps_ = 0;
  Stamp last_published_{0};
  std::int64_t last_utime_us_ = 0;
};

TEST_F(FaultHour, IsSurvived) {
  const auto all_ok_for = [&](Stamp time) {
    forget();
    run(time);
    EXPECT_EQ(by_status_[0], published_) << "reasons 0x" << std::hex << reasons_;
    EXPECT_EQ(published_, time / kPeriod);
  };
  const auto until_minute = [&](int minute) { run(kStart + minutes(minute) - now_); };
  run(seconds(5));
  all_ok_for(seconds(50));

  until_minute(1);  // a camera is unplugged and plugged in again
  faults_.gone[1] = true;
  forget();
  run(seconds(30));
  EXPECT_TRUE(alerted("MISSING"));
  EXPECT_TRUE(reasons_ & bit(PoseReason::camera_missing));
  EXPECT_EQ(by_status_[3], 0) << "poses go on from the rest";
  EXPECT_EQ(published_, 300);
  faults_.gone[1] = false;
  run(seconds(3));
  all_ok_for(seconds(20));

  until_minute(3);  // all cameras are gone
  faults_.gone.fill(true);
  run(seconds(1));
  forget();
  run(seconds(20));
  EXPECT_EQ(by_status_[3], published_);
  EXPECT_GE(published_, 40);
  faults_.gone.fill(false);
  run(seconds(3));
  all_ok_for(seconds(20));

  until_minute(5);  // stamps an hour ahead, and back
  faults_.stamps_off[0] = hours(1);
  forget();
  run(seconds(20));
  EXPECT_TRUE(reasons_ & bit(PoseReason::unsynced));
  EXPECT_EQ(by_status_[3], 0);
  faults_.stamps_off[0] = Stamp{0};
  run(seconds(20));
  all_ok_for(seconds(20));

  until_minute(7);  // the wall clock is set, the machine sleeps
  for (const Stamp set :
       {Stamp(hours(1)), Stamp(-hours(1)), Stamp(milliseconds(50)), Stamp(-milliseconds(50))}) {
    wall_ahead_ += set;
    all_ok_for(seconds(30));
  }
  slept_ += minutes(10);
  wall_ahead_ += minutes(10);
  all_ok_for(seconds(30));

  until_minute(13);  // two markers are exchanged, and put back
  faults_.exchanged = {4, 11};
  forget();
  run(seconds(60));
  EXPECT_TRUE(alerted("MOVED"));
  EXPECT_GT(by_status_[0], published_ / 2);
  faults_.exchanged.reset();
  run(seconds(60));
  all_ok_for(seconds(20));

  until_minute(17);  // ids are misread
  faults_.misread = true;
  forget();
  run(seconds(60));
  EXPECT_GT(by_status_[0], published_ / 2);
  faults_.misread = false;
  run(seconds(60));

  until_minute(20);  // solving takes longer than a period: every second set, evenly
  faults_.solving = milliseconds(150);
  run(seconds(20));
  forget();
  run(seconds(20));
  EXPECT_EQ(pacer_.divisor(), 2);
  EXPECT_EQ(published_ - by_status_[3], 100);
  faults_.solving = milliseconds(20);
  run(seconds(40));
  EXPECT_EQ(pacer_.divisor(), 1);

  until_minute(23);  // another map: statistics are gone, poses are not
  restart_localizer();
  run(seconds(3));
  all_ok_for(seconds(20));

  until_minute(25);  // every camera comes and goes once a second
  forget();
  while (now_ < kStart + minutes(55)) {
    faults_.gone.fill(true);
    run(milliseconds(500));
    faults_.gone.fill(false);
    run(milliseconds(500));
  }
  EXPECT_GT(by_status_[0], 0);

  run(seconds(5));
  all_ok_for(minutes(4));

  EXPECT_EQ(wrong_ok_, 0) << "a pose marked good is good";
  EXPECT_LE(longest_silence_, milliseconds(500));
  EXPECT_LE(most_bent_us_, 51) << "500 ppm of a period, and µs are rounded";
  EXPECT_GE(most_bent_us_, 40) << "utime did go after the wall clock";
  EXPECT_LE(log_lines_, 200);
  EXPECT_GE(log_lines_, 5);
}

}  // namespace
}  // namespace waymark
