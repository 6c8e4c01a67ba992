#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <systemd/sd-device.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include "core/base/descriptor.h"
#include "core/base/system_call.h"
#include "core/base/text_field.h"
#include "drivers/monotonic_clock.h"
#include "drivers/v4l2/device_lookup.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// Calls `visit` with the number of every open file of a process that is the device `device`.
template <typename Visit>
void for_each_descriptor_of(const fs::path& process, dev_t device, const Visit& visit) {
  std::error_code ignored;  // a process may end meanwhile, and others' files we may not see
  for (fs::directory_iterator file(process / "fd", ignored), end; !ignored && file != end;
       file.increment(ignored)) {
    struct stat info {};
    if (::stat(file->path().c_str(), &info) != 0 || !S_ISCHR(info.st_mode)) continue;
    if (info.st_rdev == device) visit(parse_whole<int>(file->path().filename().string()));
  }
}

class KernelVideoNode final : public VideoNode {
 public:
  KernelVideoNode(std::string path, Descriptor file)
      : path_(std::move(path)), file_(std::move(file)) {}

  [[nodiscard]] const std::string& path() const override { return path_; }

  [[nodiscard]] int request(unsigned long code, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(file_.get(), code, argument);  // NOLINT(cppcoreguidelines-pro-type-vararg)
    } while (result != 0 && errno == EINTR);
    return result == 0 ? 0 : errno;
  }

  [[nodiscard]] std::shared_ptr<const std::uint8_t> map(std::size_t length,
                                                        std::int64_t offset) override {
    void* const memory = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, file_.get(), offset);
    if (memory == MAP_FAILED) return nullptr;  // NOLINT: the system's own macro
    return {static_cast<const std::uint8_t*>(memory), [length](const std::uint8_t* mapped) {
              ::munmap(const_cast<std::uint8_t*>(mapped), length);  // NOLINT: its type
            }};
  }

  [[nodiscard]] bool wait(Stamp deadline, int interrupt) override {
    pollfd watched[] = {{file_.get(), POLLIN, 0}, {interrupt, POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - monotonic_now());
    const auto left_ms = std::clamp<std::int64_t>(left.count(), 0, 60'000);
    if (::poll(watched, 2, static_cast<int>(left_ms)) <= 0) return false;
    return watched[0].revents != 0;
  }

  [[nodiscard]] std::vector<DeviceHolder> holders() const override {
    std::vector<DeviceHolder> found;
    struct stat own {};
    if (::fstat(file_.get(), &own) != 0) return found;
    std::error_code ignored;
    for (fs::directory_iterator process("/proc", ignored), end; !ignored && process != end;
         process.increment(ignored)) {
      const auto pid = parse_whole<int>(process->path().filename().string());
      if (!pid) continue;
      bool holds = false;
      for_each_descriptor_of(process->path(), own.st_rdev, [&](std::optional<int> descriptor) {
        holds = holds || *pid != ::getpid() || descriptor != file_.get();
      });
      if (holds) found.push_back({*pid, first_line(process->path() / "comm")});
    }
    return found;
  }

 private:
  std::string path_;
  Descriptor file_;
};

/// The USB device that a video node belongs to; null without one.
sd_device* usb_device_of(sd_device* device) {
  sd_device* usb = nullptr;
  ::sd_device_get_parent_with_subsystem_devtype(device, "usb", "usb_device", &usb);
  return usb;
}

/// Empty where a USB device has none.
std::string attribute_of(sd_device* usb, const char* name) {
  const char* value = nullptr;
  const bool has = usb != nullptr && ::sd_device_get_sysattr_value(usb, name, &value) >= 0;
  return has ? std::string(trimmed(value)) : "";
}

/// What sits above a USB device and the hubs in between.
sd_device* controller_of(sd_device* usb) {
  const char* subsystem = "usb";
  while (usb != nullptr && std::string_view(subsystem) == "usb") {
    sd_device* above = nullptr;
    subsystem = "";
    if (::sd_device_get_parent(usb, &above) >= 0) ::sd_device_get_subsystem(above, &subsystem);
    usb = above;
  }
  return usb;
}

/// The port that a USB device is in, as drivers say it (the kernel's usb_make_path), but without
/// opening the device.
std::string port_of(sd_device* usb) {
  const char* controller = nullptr;
  if (usb == nullptr || ::sd_device_get_sysname(controller_of(usb), &controller) < 0) return {};
  return fmt::format("usb-{}-{}", controller, attribute_of(usb, "devpath"));
}

std::vector<std::string> links_of(sd_device* device) {
  std::vector<std::string> links;
  for (const char* link = ::sd_device_get_devlink_first(device); link != nullptr;
       link = ::sd_device_get_devlink_next(device)) {
    links.emplace_back(link);
  }
  std::sort(links.begin(), links.end());
  return links;
}

class KernelVideoSystem final : public VideoSystem {
 public:
  [[nodiscard]] std::vector<VideoDevice> nodes() override {
    std::vector<VideoDevice> devices;
    sd_device_enumerator* all = nullptr;
    if (::sd_device_enumerator_new(&all) < 0) return devices;
    ::sd_device_enumerator_allow_uninitialized(all);  // a machine may run without udev
    ::sd_device_enumerator_add_match_subsystem(all, "video4linux", 1);
    for (sd_device* device = ::sd_device_enumerator_get_device_first(all); device != nullptr;
         device = ::sd_device_enumerator_get_device_next(all)) {
      const char* name = nullptr;
      if (::sd_device_get_devname(device, &name) < 0) continue;
      sd_device* const usb = usb_device_of(device);
      devices.push_back({name, links_of(device), port_of(usb), attribute_of(usb, "serial"), ""});
    }
    ::sd_device_enumerator_unref(all);
    std::sort(devices.begin(), devices.end(), [](const VideoDevice& a, const VideoDevice& b) {
      return std::pair(a.node.size(), a.node) < std::pair(b.node.size(), b.node);
    });
    return devices;
  }

  [[nodiscard]] Expected<std::unique_ptr<VideoNode>> open(const std::string& node) override {
    // Not blocking: taking a buffer that is not there must say so.
    Descriptor file(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (file.valid()) return std::make_unique<KernelVideoNode>(node, std::move(file));
    if (errno == EACCES || errno == EPERM) {
      return fail(ErrorKind::permission, "{}", not_permitted(node));
    }
    return fail(ErrorKind::unavailable, "{}: can't be opened: {}", node, system_reason());
  }

  [[nodiscard]] Stamp now() const override { return monotonic_now(); }
};

}  // namespace

std::shared_ptr<VideoSystem> kernel_video_system() { return std::make_shared<KernelVideoSystem>(); }

}  // namespace waymark
