#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The software that the built programs are made of, as CycloneDX 1.5: of the libraries that they load (readelf, ldd) and
of the headers that went into them (ninja's record), each Debian source package with version and licence; what stands in
third_party.

usage: packaging/sbom.py build [--out FILE]

Exit code 1 where something linked has a licence that ours does not allow, or none that Debian states.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

CHECKOUT = pathlib.Path(__file__).resolve().parents[1]
PROGRAMS = ("strainwave", "strainwave-devices", "libstrainwave_predictor.so", "strainwave_camera.so")
# Debian's short names of licences that SPDX has another name for; of others SPDX's is the same.
SPDX = {"Expat": "MIT", "BSD-3-clause": "BSD-3-Clause", "BSD-2-clause": "BSD-2-Clause", "GPL-2+": "GPL-2.0-or-later",
        "GPL-3+": "GPL-3.0-or-later", "LGPL-2.1+": "LGPL-2.1-or-later", "LGPL-2+": "LGPL-2.0-or-later",
        "LGPL-3+": "LGPL-3.0-or-later", "LGPL-2.1": "LGPL-2.1-only", "LGPL-3": "LGPL-3.0-only", "zlib": "Zlib", "Apache-2": "Apache-2.0",
        "MPL-2": "MPL-2.0", "GPL-2": "GPL-2.0-only", "GPL-3": "GPL-3.0-only"}
# Debian states these as GPL, or not at all in a form that can be read; what holds for whoever links is in the text of
# /usr/share/doc/PACKAGE/copyright.
LINKED_AS = {"gcc-12": "GPL-3.0-or-later WITH GCC-exception-3.1", "linux": "GPL-2.0-only WITH Linux-syscall-note",
             "glibc": "LGPL-2.1-or-later"}
UNSTATED = "not stated"


def lines_of(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True, **options).stdout.splitlines()


def built(build):
    """The programs' files, by name."""
    found = {}
    for path in build.rglob("*"):
        if path.name in PROGRAMS and path.is_file() and "packages" not in path.parts:
            found[path.name] = path
    return found


def libraries(program):
    """(directly, indirectly) loaded, as files."""
    direct = {line.split("[")[1].rstrip("]") for line in lines_of("readelf", "-d", program) if "(NEEDED)" in line}
    loaded = {}
    for line in lines_of("ldd", program):
        words = line.split()
        if "=>" in words and words[2].startswith("/"):
            loaded[words[0]] = pathlib.Path(words[2]).resolve()
    return {loaded[name] for name in direct if name in loaded}, set(loaded.values())


def headers(build, programs):
    """System headers that the objects of these targets have read."""
    targets = [str(path.relative_to(build)) for path in programs]
    objects = set(re.findall(r"-o (\S+\.o)\b", "\n".join(lines_of("ninja", "-C", build, "-t", "commands", *targets))))
    found, wanted = set(), False
    for line in lines_of("ninja", "-C", build, "-t", "deps"):
        if line and not line.startswith(" "):
            wanted = line.split(":")[0] in objects
        elif wanted and line.strip().startswith("/usr/include/"):
            found.add(pathlib.Path(line.strip()).resolve())
    return found


def packages_of(files):
    """Debian's package of each file that has one."""
    packages = set()
    names = sorted({str(file) for file in files} | {str(file).replace("/usr/lib/", "/lib/", 1) for file in files})
    for begin in range(0, len(names), 500):
        done = subprocess.run(["dpkg-query", "--search", *names[begin:begin + 500]], capture_output=True, text=True, check=False)
        for line in done.stdout.splitlines():
            if not line.startswith("diversion "):
                packages.update(word.strip() for word in line.split(": /")[0].split(","))
    return packages


def licence_of(package):
    """As Debian states it for the files of the package's maker; nothing where no line states it."""
    try:
        text = pathlib.Path(f"/usr/share/doc/{package.split(':')[0]}/copyright").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    found = None
    for stanza in re.split(r"\n\s*\n", text):
        licence = re.search(r"^License: *(\S.*)$", stanza, re.MULTILINE)
        if licence and re.search(r"^Files: *\*", stanza, re.MULTILINE):
            return licence.group(1).strip()
        if licence and found is None:
            found = licence.group(1).strip()
    return found


def expression(licence):
    """(CycloneDX's form, words): an SPDX expression where every part of it is a name of SPDX."""
    words = [SPDX.get(word, word) for word in re.split(r"\s+", licence)]
    if len(words) == 1 and words[0] in set(SPDX.values()) | {"Apache-2.0", "BSL-1.0", "MPL-2.0", "curl", "EPL-2.0", "MIT"}:
        return {"license": {"id": words[0]}}
    if " WITH " in licence:
        return {"expression": licence}
    return {"license": {"name": licence}}


def is_refused(source, licence):
    """A licence that would bind whoever links: GPL without a choice or an exception."""
    if source in LINKED_AS:
        return False
    parts = re.split(r"\s+(?:or|and/or)\s+|,\s*(?=or\b)", licence)
    return licence == UNSTATED or all(re.match(r"A?GPL", part) and "exception" not in part.lower() for part in parts)


def component(source, version, binaries, how):
    licence = LINKED_AS.get(source) or next(filter(None, map(licence_of, sorted(binaries))), None) or UNSTATED
    return {"type": "library", "name": source, "version": version, "purl": f"pkg:deb/debian/{source}@{version}?arch=source",
            "bom-ref": f"debian/{source}", "licenses": [expression(licence)],
            "properties": [{"name": "strainwave:how", "value": how},
                           {"name": "strainwave:packages", "value": " ".join(sorted(binaries))}]}, licence


def third_party():
    for folder in sorted((CHECKOUT / "third_party").iterdir()):
        version = re.search(r"\b(\d+\.\d+\.\d+)\b", (folder / "README.md").read_text(encoding="utf-8"))
        first = (folder / "LICENSE").read_text(encoding="utf-8")
        yield {"type": "library", "name": folder.name, "version": version.group(1), "bom-ref": f"third_party/{folder.name}",
               "licenses": [{"license": {"id": "MIT"} if "Permission is hereby granted, free of charge" in first else
                             {"name": f"third_party/{folder.name}/LICENSE"}}],
               "properties": [{"name": "strainwave:how", "value": "part of the program"}]}


def document(build):
    """(SBOM, what is refused)"""
    programs = built(build)
    if "strainwave" not in programs:
        raise SystemExit(f"sbom.py: error: {build} has no program strainwave (expected the folder of a build: ./setup.sh build)")
    direct, loaded = set(), set()
    for path in programs.values():
        of_it, all_of_it = libraries(path)
        direct |= of_it
        loaded |= all_of_it
    own = {path.resolve() for path in programs.values()}
    how = {}
    for files, words in ((headers(build, programs.values()), "headers"), (loaded - own, "loaded by a library"),
                         (direct - own, "linked")):
        for package in packages_of(files):
            how[package] = words
    sources = {}
    for line in lines_of("dpkg-query", "--show", "--showformat=${binary:Package}\t${source:Package}\t${source:Version}\n",
                         *sorted(how)):
        binary, source, version = line.split("\t")
        words = how.get(binary) or how.get(binary.split(":")[0])
        sources.setdefault((source, version), {})[binary] = words
    components, refused = [], []
    rank = ["linked", "headers", "loaded by a library"]
    for (source, version), binaries in sorted(sources.items()):
        words = min(binaries.values(), key=rank.index)
        one, licence = component(source, version, binaries, words)
        components.append(one)
        if words != "loaded by a library" and is_refused(source, licence):
            refused.append(f"{source} {version}: {licence}")
    components += third_party()
    name, version = lines_of(programs["strainwave"], "--version")[0].split(" ", 1)
    return {"$schema": "http://cyclonedx.org/schema/bom-1.5.schema.json", "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
            "metadata": {"component": {"type": "application", "name": name, "version": version, "bom-ref": name,
                                       "licenses": [{"license": {"id": "Apache-2.0"}}]}},
            "components": components,
            "dependencies": [{"ref": name, "dependsOn": [one["bom-ref"] for one in components]}]}, refused


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    bom, refused = document(options.build)
    text = json.dumps(bom, indent=1) + "\n"
    if options.out:
        options.out.write_text(text, encoding="utf-8")
        print(f"{options.out}: {len(bom['components'])} components")
    else:
        print(text, end="")
    for one in refused:
        print(f"sbom.py: error: {one} (expected a licence that allows ours)", file=sys.stderr)
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())
