# SPDX-License-Identifier: Apache-2.0
"""Certificates for tests, by the command `openssl`: two authorities, and from the first one a broker, a monitor, one that
has expired, one for another host, and one that is not valid yet."""
import pathlib
import subprocess

SETTINGS = """
[ca]
default_ca = here
[here]
new_certs_dir = {folder}
database = {folder}/index
serial = {folder}/serial
default_md = sha256
policy = any
unique_subject = no
copy_extensions = copy
[any]
commonName = supplied
[req]
distinguished_name = name
[name]
[authority]
basicConstraints = critical,CA:true
"""


def run(*words):
    subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True)


def make(folder, **more):
    """The folder, with NAME.pem and NAME.key of each; `more` has names of others and what each is for, as in IP:127.0.0.2."""
    folder = pathlib.Path(folder)
    folder.mkdir()
    settings = folder / "openssl.cnf"
    settings.write_text(SETTINGS.format(folder=folder))
    (folder / "index").touch()
    (folder / "serial").write_text("01\n")
    for name in ("ca", "other_ca"):
        run("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-config", settings, "-extensions", "authority",
            "-subj", f"/CN={name}", "-keyout", folder / f"{name}.key", "-out", folder / f"{name}.pem")
    for name, address, begin, end in (("broker", "127.0.0.1", None, None), ("monitor", "127.0.0.1", None, None),
                                      ("elsewhere", "10.9.8.7", None, None), ("expired", "127.0.0.1", "20200101", "20200102"),
                                      ("future", "127.0.0.1", "20490101", "20490201"), *((name, what, None, None) for name, what in more.items())):
        run("req", "-new", "-newkey", "rsa:2048", "-nodes", "-config", settings, "-subj", f"/CN={name}", "-addext",
            f"subjectAltName={address if ':' in address else 'IP:' + address}", "-keyout", folder / f"{name}.key", "-out", folder / f"{name}.csr")
        dates = ("-days", "2") if begin is None else ("-startdate", f"{begin}000000Z", "-enddate", f"{end}000000Z")
        run("ca", "-batch", "-config", settings, "-notext", "-cert", folder / "ca.pem", "-keyfile", folder / "ca.key", *dates,
            "-in", folder / f"{name}.csr", "-out", folder / f"{name}.pem")
    return folder
