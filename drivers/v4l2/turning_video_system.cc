#include "drivers/v4l2/turning_video_system.h"

namespace waymark {
namespace {

/// What is common to a system and its nodes: a call, then a turn.
class Turning {
 public:
  Turning(std::shared_ptr<VideoSystem> system, TurnStamp& turns)
      : system_(std::move(system)), turns_(turns) {}

  template <typename Result>
  [[nodiscard]] Result after(Result result) const {
    turns_.touch(system_->now());
    return result;
  }
  [[nodiscard]] VideoSystem& system() const { return *system_; }

 private:
  std::shared_ptr<VideoSystem> system_;
  TurnStamp& turns_;
};

class TurningVideoNode final : public VideoNode {
 public:
  TurningVideoNode(std::unique_ptr<VideoNode> node, Turning turning)
      : node_(std::move(node)), turning_(std::move(turning)) {}

  [[nodiscard]] const std::string& path() const override { return node_->path(); }
  [[nodiscard]] int request(unsigned long code, void* argument) override {
    return turning_.after(node_->request(code, argument));
  }
  [[nodiscard]] std::shared_ptr<const std::uint8_t> map(std::size_t length,
                                                        std::int64_t offset) override {
    return turning_.after(node_->map(length, offset));
  }
  [[nodiscard]] bool wait(Stamp deadline, int interrupt) override {
    return turning_.after(node_->wait(deadline, interrupt));
  }
  [[nodiscard]] std::vector<DeviceHolder> holders() const override {
    return turning_.after(node_->holders());
  }

 private:
  std::unique_ptr<VideoNode> node_;
  Turning turning_;
};

class TurningVideoSystem final : public VideoSystem {
 public:
  explicit TurningVideoSystem(Turning turning) : turning_(std::move(turning)) {}

  [[nodiscard]] std::vector<VideoDevice> nodes() override {
    return turning_.after(turning_.system().nodes());
  }
  [[nodiscard]] Expected<std::unique_ptr<VideoNode>> open(const std::string& node) override {
    auto opened = turning_.after(turning_.system().open(node));
    if (!opened) return opened;
    return std::make_unique<TurningVideoNode>(std::move(*opened), turning_);
  }
  [[nodiscard]] Stamp now() const override { return turning_.system().now(); }

 private:
  Turning turning_;
};

}  // namespace

std::shared_ptr<VideoSystem> turning(std::shared_ptr<VideoSystem> system, TurnStamp& turns) {
  return std::make_shared<TurningVideoSystem>(Turning(std::move(system), turns));
}

}  // namespace waymark
