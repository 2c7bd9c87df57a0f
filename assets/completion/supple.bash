# Completion of supple's command line in bash. The program is asked what fits, so this file knows no verb and no option.
_supple() {
  local word=${COMP_WORDS[COMP_CWORD]} line file
  COMPREPLY=()
  while IFS= read -r line; do
    if [ "$line" != / ]; then
      COMPREPLY+=("$line")
      continue
    fi
    compopt -o filenames 2>/dev/null
    while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -f -- "$word")
  done < <("${COMP_WORDS[0]}" complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
}
complete -F _supple supple
