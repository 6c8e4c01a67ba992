#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <map>
#include <memory>

#include "core/base/one_line.h"
#include "core/base/parallel.h"
#include "core/base/range.h"
#include "core/base/standard_output.h"
#include "core/base/usage_text.h"
#include "manual/plain_help.h"
#include "mapbuilder/commands/build_command.h"
#include "mapbuilder/commands/calibrate_command.h"
#include "mapbuilder/commands/detect_command.h"
#include "mapbuilder/commands/diff_command.h"
#include "mapbuilder/commands/edit_command.h"
#include "mapbuilder/commands/evaluate_command.h"
#include "mapbuilder/commands/export_command.h"
#include "mapbuilder/commands/import_command.h"
#include "mapbuilder/commands/info_command.h"
#include "mapbuilder/commands/localize_command.h"
#include "mapbuilder/commands/print_command.h"
#include "mapbuilder/commands/update_command.h"

namespace waymark {
namespace {

using Command = std::function<Status()>;

/// Options of the estimation itself, shared by build and localize.
void add_estimation_options(CLI::App& app, BuildOptions& options) {
  const std::map<std::string, Loss> losses{{"huber", Loss::huber}, {"none", Loss::squared}};
  const std::map<std::string, bool> switches{{"on", true}, {"off", false}};
  const std::map<std::string, Weighting> weightings{{"covariance", Weighting::covariance},
                                                    {"paper", Weighting::paper},
                                                    {"none", Weighting::none}};
  app.add_option("--loss", options.loss.loss, "robust loss: huber (default) or none")
      ->transform(CLI::CheckedTransformer(losses));
  app.add_option("--loss-sigmas", options.loss.scale_sigmas, "where Huber turns linear, in sigmas")
      ->check(number_in(ObservationLoss::kScaleSigmas))
      ->capture_default_str();
  app.add_option("--gate", options.gate.enabled, "outlier gate: on (default) or off")
      ->transform(CLI::CheckedTransformer(switches));
  app.add_option("--gate-sigmas", options.gate.reject_sigmas, "the gate's threshold, in sigmas")
      ->check(number_in(OutlierGateOptions::kRejectSigmas))
      ->capture_default_str();
  app.add_option("--weight", options.noise.weighting,
                 "what weighs observations: covariance (default), paper (eq. 7) or none")
      ->transform(CLI::CheckedTransformer(weightings));
  ObservationWeightOptions& paper = options.noise.paper;
  app.add_option("--lambda-distance", paper.lambda_distance, "eq. 7's lambda 1")
      ->check(number_in(ObservationWeightOptions::kLambda))
      ->capture_default_str();
  app.add_option("--lambda-angle", paper.lambda_angle, "eq. 7's lambda 2")
      ->check(number_in(ObservationWeightOptions::kLambda))
      ->capture_default_str();
  app.add_option("--lambda-ambiguity", paper.lambda_ambiguity, "eq. 7's lambda 3")
      ->check(number_in(ObservationWeightOptions::kLambda))
      ->capture_default_str();
  app.add_option("--epsilon-rad", paper.epsilon_rad, "eq. 7's epsilon, rad")
      ->check(number_in(ObservationWeightOptions::kDivisor))
      ->capture_default_str();
  app.add_option("--max-distance-m", paper.max_distance_m, "eq. 7's d_max, m")
      ->check(number_in(ObservationWeightOptions::kDivisor))
      ->capture_default_str();
  app.add_option("--max-angle-rad", paper.max_angle_rad, "eq. 7's theta_max, rad")
      ->check(number_in(ObservationWeightOptions::kDivisor))
      ->capture_default_str();
}

void add_edges_option(CLI::App& app, bool& correct_edges) {
  app.add_flag("--correct-edges,!--no-correct-edges", correct_edges,
               "measure in a capture's images how far each camera sees edges inside the black, and "
               "correct it, where rig.yaml states no edge_bias_px; default on");
}

void add_detector_option(CLI::App& app, DetectorEngine& engine) {
  static const std::map<std::string, DetectorEngine> engines{
      {"own", DetectorEngine::own},
      {"opencv", DetectorEngine::opencv},
      {"apriltag", DetectorEngine::apriltag}};
  app.add_option("--detector", engine,
                 "who finds markers: own, or of waymark-referees opencv, apriltag (tag families); "
                 "default own")
      ->transform(CLI::CheckedTransformer(engines));
}

void add_threads_option(CLI::App& app, int& threads) {
  app.add_option("--threads", threads, "threads; 0 = all processors; never changes the result")
      ->check(number_in(kThreads));
}

void add_rules_options(CLI::App& app, FindingRules& rules) {
  app.add_flag("--strict", rules.strict, "warnings are errors");
  app.add_flag("--accept-errors", rules.accept_errors,
               "write the result although errors stand against it");
}

/// A capture, or videos in its place; shared by build and localize.
void add_input_options(CLI::App& app, CaptureInput& input) {
  app.add_flag("--redetect", input.detect.redetect, "detect even where detections.csv exists");
  add_edges_option(app, input.detect.correct_edges);
  add_detector_option(app, input.detect.engine);
  app.add_option("--rig", input.rig_yaml, "for videos and logs: Kalibr camchain");
  app.add_option("--markers", input.markers_toml,
                 "for videos and logs: families and sizes (markers.toml)");
  app.add_option("--every", input.video.every, "for videos: take one of so many frames")
      ->check(number_in(VideoOptions::kEvery))
      ->capture_default_str();
  app.add_flag("--sync", input.video.synchronized,
               "for several videos, one per camera: their stamps count from one instant");
  add_threads_option(app, input.detect.threads);
}

Command add_detect(CLI::App& app, Progress& progress) {
  auto* sub = app.add_subcommand("detect", "find the markers in a capture's images");
  auto options = std::make_shared<DetectOptions>();
  sub->add_option("CAPTURE", options->capture,
                  "capture folder, or with --rig a log of locd's detections")
      ->required();
  sub->add_option("-o,--output", options->output, "default: CAPTURE/detections.csv");
  sub->add_option("--rig", options->rig, "for logs: rig.yaml that locd had");
  sub->add_option("--markers", options->markers, "for logs: families and sizes (markers.toml)");
  add_edges_option(*sub, options->correct_edges);
  add_detector_option(*sub, options->engine);
  add_rules_options(*sub, options->rules);
  add_threads_option(*sub, options->threads);
  return [options, &progress] { return run_detect(*options, progress, std::cout, std::cerr); };
}

void vary_by_name(VariableCalibration& variable, const std::string& name) {
  if (name == "extrinsics") variable.extrinsics = true;
  if (name == "intrinsics") variable.intrinsics = true;
  if (name == "sizes") variable.sizes = true;
}

Command add_build(CLI::App& app, Progress& progress) {
  auto* sub = app.add_subcommand("build", "build a marker map from captures");
  auto options = std::make_shared<BuildCommandOptions>();
  sub->add_option("CAPTURE", options->input.paths,
                  "capture folders, or videos or logs of locd's detections with --rig")
      ->required();
  sub->add_option("-o,--output", options->output, "map file")->required();
  sub->add_option("--trajectory", options->trajectory, "write the rig's poses (TUM)");
  sub->add_option("--report", options->report, "folder for summary.json and a page (index.html)");
  sub->add_flag("--mono", options->mono, "every image a frame of its own");
  sub->add_option("--survey", options->survey, "distances and points measured on site (TOML)");
  sub->add_option_function<std::vector<std::string>>(
         "--refine",
         [options](const std::vector<std::string>& names) {
           for (const std::string& name : names) vary_by_name(options->build.refine, name);
         },
         "extrinsics,intrinsics,sizes: what the images may correct")
      ->delimiter(',')
      ->allow_extra_args(false)  // what follows is the next argument, not another name
      ->check(CLI::IsMember({"extrinsics", "intrinsics", "sizes"}));
  sub->add_option("--refined-rig", options->refined_rig,
                  "where a rig is written that was refined or whose edges were measured; default: "
                  "MAP with .yaml, numbered if several");
  sub->add_option("--frame-of", options->frame_of, "keep the world of this earlier map");
  sub->add_option("--quarantine", options->quarantine,
                  "quarantine.json of a vehicle: what it found moved does not carry the world");
  static const std::map<std::string, LevelBy> levels{{"floor", LevelBy::floor},
                                                     {"walls", LevelBy::walls}};
  sub->add_option("--level", options->level, "z up by markers on the floor, or on walls")
      ->transform(CLI::CheckedTransformer(levels))
      ->excludes("--frame-of");
  static const std::map<std::string, BundleSolver> solvers{{"own", BundleSolver::own},
                                                           {"ceres", BundleSolver::ceres}};
  sub->add_option("--solver", options->build.solver,
                  "what adjusts: own (default) or ceres, slower, a second opinion")
      ->transform(CLI::CheckedTransformer(solvers));
  add_rules_options(*sub, options->rules);
  add_input_options(*sub, options->input);
  add_estimation_options(*sub, options->build);
  return [options, &progress] {
    options->input.survey_not_asked = !options->survey;
    return run_build(*options, progress, std::cout, std::cerr);
  };
}

Command add_calibrate(CLI::App& app, Progress& progress) {
  auto* sub = app.add_subcommand(
      "calibrate", "find lenses and places of a rig's cameras from captures; no rig file needed");
  auto options = std::make_shared<CalibrateCommandOptions>();
  sub->add_option("CAPTURE", options->input.paths, "capture folders of one rig")->required();
  sub->add_option("-o,--output", options->output, "rig file to write (Kalibr camchain)")
      ->required();
  static const std::map<std::string, std::optional<Distortion>> lenses{
      {"auto", std::nullopt},
      {"none", Distortion::none},
      {"radtan", Distortion::radtan},
      {"rational", Distortion::rational},
      {"equidistant", Distortion::equidistant},
      {"eucm", Distortion::eucm},
      {"ds", Distortion::double_sphere}};
  sub->add_option_function<std::string>(
         "--model",
         [options](const std::string& name) { options->calibration.lens = lenses.at(name); },
         "lens: auto (by evidence, default), none, radtan, rational, equidistant, eucm or ds")
      ->check(CLI::IsMember({"auto", "none", "radtan", "rational", "equidistant", "eucm", "ds"}));
  sub->add_option("--report", options->report, "folder for summary.json and a page (index.html)");
  sub->add_flag("--redetect", options->input.detect.redetect,
                "detect even where detections.csv exists");
  add_detector_option(*sub, options->input.detect.engine);
  add_rules_options(*sub, options->rules);
  add_threads_option(*sub, options->input.detect.threads);
  return [options, &progress] { return run_calibrate(*options, progress, std::cout, std::cerr); };
}

Command add_update(CLI::App& app, Progress& progress) {
  auto* sub =
      app.add_subcommand("update", "bring a map up to date by captures that see some of it");
  auto options = std::make_shared<UpdateCommandOptions>();
  sub->add_option("OLD", options->old_map, "map file")->required();
  sub->add_option("CAPTURE", options->input.paths, "capture folders, or videos with --rig")
      ->required();
  sub->add_option("-o,--output", options->output, "map file to write; may be OLD itself")
      ->required();
  sub->add_option("--quarantine", options->quarantine,
                  "quarantine.json of a vehicle: what it found moved does not carry the world");
  sub->add_flag("--drop-unseen", options->drop_unseen,
                "markers that are not seen where they should be leave the map");
  sub->add_option("--report", options->report, "folder for summary.json and a page (index.html)");
  add_rules_options(*sub, options->rules);
  add_input_options(*sub, options->input);
  add_estimation_options(*sub, options->build);
  return [options, &progress] { return run_update(*options, progress, std::cout, std::cerr); };
}

Command add_localize(CLI::App& app, Progress& progress) {
  auto* sub = app.add_subcommand("localize", "localize a capture against a finished map");
  auto options = std::make_shared<LocalizeOptions>();
  sub->add_option("CAPTURE", options->input.paths, "capture folder, or videos with --rig")
      ->required();
  sub->add_option("--map", options->map, "map file")->required();
  sub->add_option("--trajectory", options->trajectory, "poses to write (TUM)")->required();
  sub->add_option("--quarantine", options->quarantine,
                  "quarantine.json of a vehicle: what it found moved is left out");
  sub->add_flag("--mono", options->mono, "every image a frame of its own");
  add_rules_options(*sub, options->rules);
  add_input_options(*sub, options->input);
  add_estimation_options(*sub, options->build);
  return [options, &progress] { return run_localize(*options, progress, std::cout, std::cerr); };
}

Command add_info(CLI::App& app) {
  auto* sub = app.add_subcommand("info", "say what a map holds");
  auto options = std::make_shared<InfoOptions>();
  sub->add_option("MAP", options->map, "map file")->required();
  sub->add_option("--distance", options->distance,
                  "two ids: how far these markers are apart, and how sure that is");
  sub->add_flag("--json", options->json, "as JSON");
  return [options] { return run_info(*options, std::cout); };
}

Command add_edit(CLI::App& app) {
  auto* sub = app.add_subcommand("edit", "change by hand what somebody knows about a map");
  auto options = std::make_shared<EditOptions>();
  sub->add_option("MAP", options->map, "map file")->required();
  sub->add_option("-o,--output", options->output, "map file to write; may be MAP itself")
      ->required();
  sub->add_option("--remove", options->remove, "ids to take out, such as 100-199,205")
      ->allow_extra_args(false);
  sub->add_option("--rename", options->rename,
                  "ID=ID, the old and the new name; again, or with a comma, for more")
      ->delimiter(',')
      ->allow_extra_args(false);
  sub->add_option("--accept", options->accept,
                  "ids that one view alone has placed, and that somebody has looked at")
      ->allow_extra_args(false);
  return [options] { return run_edit(*options, std::cout, std::cerr); };
}

Command add_diff(CLI::App& app) {
  auto* sub = app.add_subcommand("diff", "say what differs between two maps of a building");
  auto options = std::make_shared<DiffOptions>();
  sub->add_option("OLD", options->old_map, "map file")->required();
  sub->add_option("NEW", options->new_map, "map file")->required();
  sub->add_flag("--json", options->json, "as JSON");
  return [options] { return run_diff(*options, std::cout); };
}

Command add_export(CLI::App& app) {
  auto* sub = app.add_subcommand("export", "write a map in another form");
  auto options = std::make_shared<ExportOptions>();
  sub->add_option("MAP", options->map, "map file")->required();
  sub->add_option("--format", options->format, "tum, json, csv or ply")->required();
  sub->add_option("-o,--output", options->output, "file to write")->required();
  return [options] { return run_export(*options, std::cerr); };
}

Command add_import(CLI::App& app, Progress& progress) {
  auto* sub = app.add_subcommand(
      "import", "make a map of its JSON form, or a capture of what others recorded");
  auto options = std::make_shared<ImportOptions>();
  sub->add_option(
         "FILE", options->input,
         "a map's JSON as export writes it; a recording of ROS 2 (rosbag2's folder or file, "
         "MCAP); lcm-logger's log of locd's detections")
      ->required();
  sub->add_option("-o,--output", options->output, "map file, or capture folder of a recording")
      ->required();
  sub->add_option("--rig", options->description.rig, "for recordings: becomes rig.yaml");
  sub->add_option("--markers", options->description.markers,
                  "for recordings: becomes markers.toml");
  sub->add_option("--camera", options->cameras,
                  "of ROS 2: a topic of images; again for each camera, cam0's first; default: all, "
                  "by name")
      ->allow_extra_args(false);
  sub->add_option("--every", options->every, "of ROS 2: take one of so many images of each topic")
      ->check(number_in(VideoOptions::kEvery));
  sub->add_option("--channel", options->channel, "of LCM: where several channels hold detections");
  return [options, &progress] { return run_import(*options, progress, std::cout, std::cerr); };
}

Command add_print(CLI::App& app) {
  auto* sub = app.add_subcommand("print", "make a PDF of markers, and markers.toml beside it");
  auto options = std::make_shared<PrintOptions>();
  auto advice = std::make_shared<PrintAdviceOptions>();
  auto* advise = sub->add_flag("--advise", advice->asked, "say which size a rig's cameras need");
  sub->add_option("--rig", advice->rig, "with --advise: rig.yaml")->needs(advise);
  sub->add_option("--range-m", advice->range_m, "with --advise: farthest a marker is read, m")
      ->needs(advise);
  sub->add_option("--family", options->families, "such as tag36h11; once, or once per --ids")
      ->allow_extra_args(false)
      ->excludes(advise);
  sub->add_option("--ids", options->ids, "such as 0-199,205; again for another family or size")
      ->allow_extra_args(false)
      ->excludes(advise);
  sub->add_option("--size-m", options->sizes_m, "edge of the black square; once, or per --ids")
      ->allow_extra_args(false)
      ->excludes(advise);
  sub->add_option("--paper", options->paper, "a4, a3, letter, or width x height in mm")
      ->capture_default_str();
  sub->add_option("-o,--output", options->output, "PDF to write")->excludes(advise);
  return [options, advice]() -> Status {
    if (advice->asked) return run_print_advice(*advice, std::cout, std::cerr);
    if (options->output.empty()) return fail(ErrorKind::usage, "print: -o FILE.pdf is required");
    return run_print(*options, std::cout);
  };
}

Command add_evaluate(CLI::App& app) {
  auto* sub = app.add_subcommand("evaluate", "compare a map with the truth");
  auto options = std::make_shared<EvaluateOptions>();
  sub->add_option("--map", options->map, "map file")->required();
  sub->add_option("--trajectory", options->trajectory, "poses to compare, too (TUM)");
  sub->add_option("--truth", options->truth, "a capture's groundtruth folder")->required();
  sub->add_flag("--json", options->json, "as JSON");
  return [options] { return run_evaluate(*options, std::cout); };
}

int run(int argc, char** argv) {
  CLI::App app("Turns recorded captures of a building into a marker map.", "mapbuilder");
  app.formatter(std::make_shared<PlainHelp>());
  app.failure_message(
      [](const CLI::App*, const CLI::Error& error) { return usage_text(error.what()); });
  app.set_version_flag("--version", WAYMARK_VERSION);
  app.require_subcommand(1);
  Progress progress;
  std::map<std::string, Command> commands;
  commands["detect"] = add_detect(app, progress);
  commands["build"] = add_build(app, progress);
  commands["calibrate"] = add_calibrate(app, progress);
  commands["update"] = add_update(app, progress);
  commands["localize"] = add_localize(app, progress);
  commands["info"] = add_info(app);
  commands["edit"] = add_edit(app);
  commands["diff"] = add_diff(app);
  commands["export"] = add_export(app);
  commands["import"] = add_import(app, progress);
  commands["print"] = add_print(app);
  commands["evaluate"] = add_evaluate(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked_for_help = app.exit(error) == 0;
    return asked_for_help ? exit_code_after_output(0, app.get_name())
                          : static_cast<int>(ErrorKind::usage);
  }
  const Status status = commands.at(app.get_subcommands().front()->get_name())();
  if (status) return exit_code_after_output(0, app.get_name());
  std::cerr << line_of(status.error(), app.get_name()) << '\n';
  return status.error().exit_code();
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  try {
    return waymark::run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("mapbuilder: out of memory: use fewer captures at a time\n", stderr);
    return static_cast<int>(waymark::ErrorKind::unavailable);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mapbuilder: internal error: %s; please report it\n",
                 waymark::in_one_line(error.what()).c_str());
    return static_cast<int>(waymark::ErrorKind::internal);
  }
}
