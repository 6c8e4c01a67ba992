#include "tests/mapbuilder/program/run_program.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "core/camera/kalibr.h"
#include "core/capture/detections_csv_text.h"

namespace waymark::test {
namespace {

std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

}  // namespace

ProgramRun run_mapbuilder(const std::vector<std::string>& arguments, std::size_t max_file_bytes) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "out";
  const auto err = folder.path() / "err";
  std::vector<std::string> words{WAYMARK_MAPBUILDER};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::freopen(out.c_str(), "w", stdout) == nullptr) ::_exit(126);
    if (::freopen(err.c_str(), "w", stderr) == nullptr) ::_exit(126);
    if (max_file_bytes > 0) {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{max_file_bytes, max_file_bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(out), content_of(err)};
}

int error_lines(const ProgramRun& run) {
  std::istringstream lines(run.err);
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    count += line.rfind("mapbuilder:", 0) == 0 || line.rfind("error [", 0) == 0 ? 1 : 0;
  }
  return count;
}

void write_capture(const SyntheticRoom& room, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write(folder / "rig.yaml", format_camchain(room.rig));
  write(folder / "markers.toml", format_marker_catalog(room.catalog));
  write(folder / "detections.csv",
        format_detections_csv(room.images, room.rig, room.catalog, "synthetic"));
}

}  // namespace waymark::test
