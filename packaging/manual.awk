# SPDX-License-Identifier: Apache-2.0
# A manual page of what --help says (manual.sh). Each file is the help of the command that the file is called, laid out
# by CLI11: what it does with examples, the usage, then parts with a name and what is said of it. What a second file says
# comes below a heading of its own. Variables: page, version, name (of the program with the commands), pages (all of them).

BEGIN {
  glyph["\\"] = "\\(rs"; glyph["-"] = "\\-"; glyph["\""] = "\\(dq"; glyph["'"] = "\\(aq"
  glyph["`"] = "\\(ga"; glyph["^"] = "\\(ha"; glyph["~"] = "\\(ti"
  title["Positionals:"] = "Arguments"; title["Options:"] = "Options"; title["Subcommands:"] = "Commands"
}

# What groff has to read in order to show just that text.
function shown(text,    out, at, letter) {
  gsub(/…/, "...", text)  # which not every output device of groff has
  for (at = 1; at <= length(text); ++at) {
    letter = substr(text, at, 1)
    out = out (letter in glyph ? glyph[letter] : letter)
  }
  return (out ~ /^\./ ? "\\&" : "") out
}

function trimmed(text) { gsub(/^ +| +$/, "", text); return text }
function add(line) { body[count] = body[count] line "\n" }
function add_heading(words) { add(count == 1 ? ".SH " toupper(words) : ".SS " words) }

function broken(what) {
  printf "manual.sh: error: '%s --help': %s\n", called[count], what >"/dev/stderr"
  wrong = 1
  exit 1
}

# The first sentence, or what stands before its colon.
function summary(text) {
  sub(/[.:]$/, "", text)
  if (match(text, /[.:] /)) text = substr(text, 1, RSTART - 1)
  if (index(text, called[count] " ") == 1) text = substr(text, length(called[count]) + 2)
  return tolower(substr(text, 1, 1)) substr(text, 2)
}

# The name that was read last, with what is said on its line unless the name takes it whole.
function end_entry(whole,    name_there, said, first) {
  if (entry == "") return
  whole = whole || substr(entry, 30, 1) != " "
  name_there = trimmed(whole ? entry : substr(entry, 1, 30))
  said = whole ? "" : trimmed(substr(entry, 31))
  first = index(name_there " ", " ")
  add(".TP\n\\fB" shown(substr(name_there, 1, first - 1)) "\\fR" shown(substr(name_there, first)))
  if (said != "") add(shown(said))
  entry = ""
}

function end_file() {
  if (count == 0) return
  end_entry(0)
  if (part == "about") broken("no usage (expected a line 'Usage: ' with [OPTIONS])")
  if (examples != "") {
    add_heading("Examples")
    add(".nf\n" examples ".fi")
  }
}

FNR == 1 {
  end_file()
  called[++count] = FILENAME
  part = "about"
  about = examples = ""
  in_example = 0
}

part == "about" && /^Usage: .* \[OPTIONS\]/ {
  if (about == "") broken("nothing says what it does (expected a sentence before 'Usage: ')")
  names[count] = shown(page) " \\- " shown(summary(about))
  # In the program's place there is the file that it was built as.
  synopsis[count] = "\\fB" shown(called[count]) "\\fR" shown(substr($0, index($0, " [OPTIONS]")))
  add_heading("Description")
  add(shown(about))
  part = "usage"
  next
}
part == "about" && /^Example: / { in_example = 1; examples = examples shown(substr($0, 10)) "\n"; next }
part == "about" && in_example && /^ / { examples = examples shown(trimmed($0)) "\n"; next }
part == "about" { about = trimmed(about " " $0); in_example = 0; next }

/^ *$/ { next }
/^[^ ]/ {
  if (!($0 in title)) broken("'" $0 "' is no part of a help (expected Positionals:, Options: or Subcommands:)")
  end_entry(0)
  part = title[$0]
  add_heading(part)
  next
}
part == "usage" { broken("'" $0 "' follows the usage (expected Positionals:, Options: or Subcommands:)") }

# Names have 30 columns. A longer one has a line to itself, and what is said of it follows on the next: that alone tells
# where just those columns end with one space.
/^  [^ ]/ {
  end_entry(0)
  in_example = 0
  entry = $0
  next
}

# More of what is said; a command's examples stand in its own page.
{
  end_entry(substr(entry, 29, 1) != " ")
  if (part == "Commands" && /^ *Example: /) in_example = 1
  if (!in_example) add(shown(trimmed($0)))
}

END {
  if (wrong) exit 1
  end_file()
  if (wrong) exit 1
  printf ".\\\" SPDX-License-Identifier: Apache-2.0\n.\\\" Made by packaging/manual.sh of what --help says.\n"
  printf ".TH %s 1 \"\" \"%s %s\" \"User Commands\"\n.nh\n.ad l\n", shown(toupper(page)), name, version
  printf ".SH NAME\n"
  for (at = 1; at <= count; ++at) printf "%s%s\n", (at > 1 ? ".br\n" : ""), names[at]
  printf ".SH SYNOPSIS\n"
  for (at = 1; at <= count; ++at) printf "%s%s\n", (at > 1 ? ".br\n" : ""), synopsis[at]
  for (at = 1; at <= count; ++at) printf "%s%s", (at > 1 ? ".SH \"PROGRAM " shown(toupper(called[at])) "\"\n" : ""), body[at]
  printf ".SH SEE ALSO\n.BR %s (1)", shown(name)
  # Those above and below.
  total = split(pages, all, " ")
  for (at = 1; at <= total; ++at)
    if (index(all[at], page "-") == 1 || index(page, all[at] "-") == 1) printf ",\n.BR %s (1)", shown(all[at])
  printf "\n"
}
