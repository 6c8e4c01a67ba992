# Completion of Waymark's programs in bash: commands and options as --help lists them, files otherwise.
_waymark() {
  local program=$1 word=$2 command= help i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${COMP_WORDS[i]} in
      -*) ;;
      *) command=${COMP_WORDS[i]}; break ;;
    esac
  done
  if [[ $word == -* ]]; then
    help=$("$program" $command --help 2>/dev/null) || help=$("$program" --help 2>/dev/null)
    COMPREPLY=($(compgen -W "$(grep -oE '^ +-[^ ]+' <<<"$help" | tr ', ' '\n\n')" -- "$word"))
  elif [[ -z $command ]]; then
    help=$("$program" --help 2>/dev/null)
    COMPREPLY=($(compgen -W "$(sed -n '/^Subcommands:/,$s/^  \([a-z]\+\) .*/\1/p' <<<"$help")" -- "$word"))
  fi
}
complete -o default -F _waymark locd locdctl mapbuilder simulator
