// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/openhaptics/hd_runtime.h>

#include <utility>

#include <tactus/base/rule.h>
#include <tactus/device/shared_library.h>

namespace tactus::device::openhaptics {
namespace {

constexpr const char* kLibrary = "libHD.so";

tl::unexpected<Diagnostic> refuse(const std::string& path, std::string detail, std::string remedy) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::unsupported, "R-DEV-3").value(),
                                   .file = path,
                                   .detail = std::move(detail),
                                   .remedy = std::move(remedy)});
}

}  // namespace

tl::expected<Runtime, Diagnostic> Runtime::load(const std::string& path) {
  const std::string name = path.empty() ? kLibrary : path;
  auto library = SharedLibrary::load(name);
  if (!library)
    return refuse(name, library.error(),
                  "install the vendor's runtime (OpenHaptics and the driver of the device), or name the library with --runtime");
  Runtime runtime;
  library->find("hdInitDevice", runtime.init_device);
  library->find("hdDisableDevice", runtime.disable_device);
  library->find("hdMakeCurrentDevice", runtime.make_current_device);
  library->find("hdBeginFrame", runtime.begin_frame);
  library->find("hdEndFrame", runtime.end_frame);
  library->find("hdEnable", runtime.enable);
  library->find("hdGetDoublev", runtime.get_doubles);
  library->find("hdGetIntegerv", runtime.get_integers);
  library->find("hdGetString", runtime.get_string);
  library->find("hdSetDoublev", runtime.set_doubles);
  library->find("hdStartScheduler", runtime.start_scheduler);
  library->find("hdStopScheduler", runtime.stop_scheduler);
  library->find("hdScheduleAsynchronous", runtime.schedule);
  library->find("hdUnschedule", runtime.unschedule);
  library->find("hdGetError", runtime.get_error);
  library->find("hdGetErrorString", runtime.error_text);
  if (library->missing() != nullptr)
    return refuse(name, std::string("no function ") + library->missing(), "take a runtime of OpenHaptics 3.4 or newer");
  return runtime;
}

}  // namespace tactus::device::openhaptics
