# Writes OUTPUT, a source that defines builtin_scenes() from the scene files SCENES (run with cmake -P).
set(entries "")
foreach(file IN LISTS SCENES)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  string(APPEND entries "      {\"${name}\", R\"scene(${text})scene\"},\n")
endforeach()
file(WRITE ${OUTPUT} "#include \"simulator/scene_library.h\"

namespace waymark::simulator {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = {
${entries}  };
  return scenes;
}

}  // namespace waymark::simulator
")
