# Stages in a folder that outlives builds. Sourced by build, which holds the folder's lock.

cache=${WAYMARK_VM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/waymark-vm}

# cached STAGE FACTS SCRIPT FILES...: prints the folder that SCRIPT (it writes to $OUT) filled for these
# facts and these files' content; runs it when there is none. A folder appears whole or not at all.
cached() {
  local stage=$1 facts=$2 script=$3 key folder
  shift 2
  key=$({ echo "$facts"; cat "$@"; } | sha256sum | cut -c1-16)
  folder=$cache/$stage-$key
  if [ ! -d "$folder" ]; then
    local begun=$SECONDS
    rm -rf "$folder.part"
    mkdir -p "$folder.part"
    OUT=$folder.part bash -euo pipefail -O inherit_errexit "$script" >"$cache/$stage.log" 2>&1 || {
      { echo "vm image: $(basename "$script") failed; the end of $cache/$stage.log:"; tail -25 "$cache/$stage.log"; } >&2
      return 69
    }
    mv -T "$folder.part" "$folder"
    echo "vm image: $stage made in $((SECONDS - begun)) s" >&2
  fi
  touch "$folder"
  echo "$folder"
}

# Deletes stages that no run has asked for in two weeks.
forget_unused() {
  find "$cache" -mindepth 1 -maxdepth 1 -type d -mtime +14 -exec rm -rf {} +
}
