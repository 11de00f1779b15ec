# SPDX-License-Identifier: Apache-2.0
# Completion of strainwave and strainwave-devices in bash: commands and options as their own --help lists them, else files.

_strainwave_commands() { sed -nE '1,/^Subcommands:$/d; s/^  ([a-z-]+) .*/\1/p'; }

_strainwave_options() { sed -nE 's/^  (-[a-zA-Z],)?(--[a-z-]+).*/\2/p'; }

_strainwave() {
  local word=${COMP_WORDS[COMP_CWORD]} help commands
  local -a path=("${COMP_WORDS[0]}")
  COMPREPLY=()
  # As deep as there are commands of commands: `strainwave bench check`.
  while help=$("${path[@]}" --help 2>/dev/null); do
    commands=$(_strainwave_commands <<<"$help")
    ((${#path[@]} < COMP_CWORD)) && grep -qxF -- "${COMP_WORDS[${#path[@]}]}" <<<"$commands" || break
    path+=("${COMP_WORDS[${#path[@]}]}")
  done
  if [[ $word == -* ]]; then
    commands=$(_strainwave_options <<<"$help")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word")
}

# `default`: files where nothing else fits.
complete -o default -F _strainwave strainwave strainwave-devices
