#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Flips one bit after the other in the files of two campaigns, one that is complete and one that was killed under way:
`verify` names the file, or what the file says is not of the campaign (the lock, the index of the journal's log, which
is made anew by whoever opens it).

  tests/simulation/verify_flips.py --program build/strainwave --flips 1000 --seed 1

Half of the flips fall on any file alike, half on any byte alike. What SQLite and HDF5 leave unused within a file that
has no digest yet is proven harmless by reading all records and rows: the same as before.
"""
import json
import pathlib
import sys
import tempfile

import bit_flips

OF_NO_CAMPAIGN = ("lock", "campaign.db-shm")


def verify(campaign):
    code, out, error = campaign.run("verify", campaign.folder, "--json")
    return code, json.loads(out) if out else None, error


def named(document):
    """Files that are found damaged or missing."""
    names = {file["path"] for file in document["files"] if file["state"] in ("damaged", "missing")}
    journal = document["journal"]
    if journal["state"] != "whole":
        names.add("campaign.db")
    if journal["log_damage"]:
        names.add("campaign.db-wal")
    return names


def shown(campaign):
    """What status and recompute make of it; of unfinished phases what --resume does."""
    return [look()[:2] for look in campaign.looks()]


def outcome_of(campaign, path, reference):
    relative = str(path.relative_to(campaign.folder))
    code, document, error = verify(campaign)
    if code in (1, 2) and document and named(document) == {relative}:
        return "found"
    if code != 0:
        return f"WRONG: exit {code}, {document and named(document)}, {error}"
    if relative in OF_NO_CAMPAIGN:
        return "of no campaign"
    return "harmless" if shown(campaign) == reference else "SILENT"


def main():
    options = bit_flips.options_of(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        schedule = bit_flips.short_schedule(scratch)
        campaigns = [bit_flips.Complete(options.program, scratch / "complete", schedule),
                     bit_flips.Killed(options.program, scratch / "killed", schedule)]
        for campaign in campaigns:
            code, document, error = verify(campaign)
            assert code == 0, (code, document, error)
        references = [shown(campaign) for campaign in campaigns]
        return bit_flips.try_flips(options, campaigns, references, outcome_of, ("WRONG", "SILENT"))


if __name__ == "__main__":
    sys.exit(main())
