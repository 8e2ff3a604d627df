
# Puts what KIND allows for the word CURRENT into COMPREPLY.
_PROGRAM_reply() { # KIND CURRENT
  local kind=$1 current=$2 word head
  case $kind in
    words*)
      for word in ${kind#words}; do
        if [[ $word == *: && $current == "$word"* ]]; then
          _PROGRAM_reply files "${current#"$word"}"
          COMPREPLY=("${COMPREPLY[@]/#/$word}")
          return
        fi
      done
      mapfile -t COMPREPLY < <(compgen -W "${kind#words}" -- "$current")
      if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *: ]]; then compopt -o nospace 2>/dev/null; fi
      ;;
    files*)
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      compopt -o filenames 2>/dev/null
      local suffix=${kind#files} kept=()
      suffix=${suffix# }
      for word in "${COMPREPLY[@]}"; do
        if [[ $word == *"$suffix" || -d $word ]]; then kept+=("$word"); fi
      done
      if ((${#kept[@]})); then COMPREPLY=("${kept[@]}"); fi
      ;;
    settings)
      if [[ $current == *=* ]]; then
        head=${current%%=*}
        _PROGRAM_reply "$(_PROGRAM_setting "$head")" "${current#*=}"
        COMPREPLY=("${COMPREPLY[@]/#/$head=}")
      else
        mapfile -t COMPREPLY < <(compgen -W "$(_PROGRAM_settings)" -S = -- "$current")
        compopt -o nospace 2>/dev/null
      fi
      ;;
  esac
}

_PROGRAM() {
  local IFS=$' \t\n' word kind option='' command=PROGRAM glue='' i
  local -a words=()
  COMPREPLY=()
  # The line's words are cut at = and : as well; put those together again.
  for ((i = 0; i <= COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if [[ -z $word && $i == "$COMP_CWORD" && ${COMP_LINE:COMP_POINT-1:1} == ' ' ]]; then glue=''; fi
    if ((i > 1)) && [[ $glue || $word == [=:]* ]]; then words[-1]+=$word; else words+=("$word"); fi
    glue=''
    if [[ $word == [=:] ]]; then glue=1; fi
  done
  # Which command they name, and which option waits for a value.
  for word in "${words[@]:1:${#words[@]}-2}"; do
    if [[ $option ]]; then
      option=''
    elif [[ $word == -* ]]; then
      kind=$(_PROGRAM_value "$command $word")
      if [[ $word != *=* && $kind && $kind != maybe* ]]; then option=$word; fi
    elif [[ " $(_PROGRAM_commands "$command") " == *" $word "* ]]; then
      command+=" $word"
    fi
  done
  local typed=${words[-1]}
  if [[ $option ]]; then
    _PROGRAM_reply "$(_PROGRAM_value "$command $option")" "$typed"
  elif [[ $typed == --*=* ]]; then
    kind=$(_PROGRAM_value "$command ${typed%%=*}")
    _PROGRAM_reply "${kind#maybe }" "${typed#*=}"
    COMPREPLY=("${COMPREPLY[@]/#/${typed%%=*}=}")
  elif [[ $typed == -* ]]; then
    _PROGRAM_reply "words $(_PROGRAM_options "$command")" "$typed"
  elif [[ $(_PROGRAM_commands "$command") ]]; then
    _PROGRAM_reply "words $(_PROGRAM_commands "$command")" "$typed"
  else
    _PROGRAM_reply "$(_PROGRAM_value "$command ")" "$typed"
  fi
  # Bash replaces only what stands behind the last character at which it cuts.
  local cut=${COMP_WORDBREAKS//[^=:]/}
  if [[ $cut && $typed == *["$cut"]* ]]; then COMPREPLY=("${COMPREPLY[@]#"${typed%"${typed##*["$cut"]}"}"}"); fi
}

complete -F _PROGRAM PROGRAM
