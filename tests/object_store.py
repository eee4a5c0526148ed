"""Datasets in an object store, against a real S3 server (moto) in a process of its own.

    python -m venv venv && venv/bin/pip install 'moto[server]'
    cargo build --release --package peelnet --features object-store
    venv/bin/python tests/object_store.py target/release/peelnet

Tested: models; conditional commits, two writers of one part, a killed writer, throttling, connections that are cut before and after the server
acted, wrong credentials (never printed), a clock that is off, a bucket that is not there, is full, or may only be read. Prints one line for each test and ends
with 1 if any failed. Nothing is left running.
"""

import http.client
import http.server
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time

import boto3

SECRET = "wJalrXUtnFEMI/K7MDENG/SECRETSECRET"
KEY = "AKIAIOSFODNN7EXAMPLE"
LISTS = 5000  # five parts
PARTS = 5


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Server:
    """A moto server; with `open_calls`, credentials count after so many calls."""

    def __init__(self, open_calls=None):
        self.port = free_port()
        env = dict(os.environ)
        if open_calls is not None:
            env["INITIAL_NO_AUTH_ACTION_COUNT"] = str(open_calls)
        command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(self.port)]
        self.process = subprocess.Popen(command, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(300):
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                time.sleep(0.1)
        raise SystemExit("moto does not start")

    def client(self, service="s3", key=KEY, secret=SECRET):
        return boto3.client(
            service,
            endpoint_url=f"http://127.0.0.1:{self.port}",
            aws_access_key_id=key,
            aws_secret_access_key=secret,
            region_name="us-east-1",
        )

    def end(self):
        self.process.terminate()
        self.process.wait()


class Proxy:
    """Between a command and the server. `hook(method, path, n)` says what happens to request n: None, "slow", "cut-before", "cut-after", or an
    error's status and code."""

    def __init__(self, port, hook):
        self.requests = []
        proxy = self

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, *_):
                pass

            def act(self):
                length = int(self.headers.get("content-length") or 0)
                body = self.rfile.read(length)
                proxy.requests.append((self.command, self.path))
                what = hook(self.command, self.path, len(proxy.requests))
                if what == "slow":
                    text = b"<Error><Code>SlowDown</Code><Message>Please reduce your request rate.</Message></Error>"
                    self.answer(503, {"content-type": "application/xml"}, text)
                    return
                if isinstance(what, tuple):
                    status, code = what
                    text = f"<Error><Code>{code}</Code><Message>{KEY} {SECRET}</Message></Error>"
                    self.answer(status, {"content-type": "application/xml"}, text.encode())
                    return
                if what == "cut-before":
                    self.cut()
                    return
                upstream = http.client.HTTPConnection("127.0.0.1", port)
                headers = {k: v for k, v in self.headers.items() if k.lower() not in ("connection", "transfer-encoding")}
                upstream.request(self.command, self.path, body, headers)
                answer = upstream.getresponse()
                text = answer.read()
                upstream.close()
                if what == "cut-after":
                    self.cut()
                    return
                self.answer(answer.status, dict(answer.getheaders()), text)

            def cut(self):
                self.close_connection = True
                self.connection.shutdown(socket.SHUT_RDWR)

            def answer(self, status, headers, text):
                self.send_response_only(status)
                for name, value in headers.items():
                    if name.lower() not in ("connection", "transfer-encoding", "content-length"):
                        self.send_header(name, value)
                length = headers.get("Content-Length") if self.command == "HEAD" else len(text)
                self.send_header("Content-Length", str(length or 0))
                self.end_headers()
                try:
                    self.wfile.write(text)
                except BrokenPipeError:
                    # A writer that was killed waits for no answer.
                    self.close_connection = True

            do_GET = do_PUT = do_HEAD = do_POST = do_DELETE = act

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def end(self):
        self.server.shutdown()
        self.server.server_close()


class Run:
    """What a command gave."""

    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    def json(self):
        assert self.code == 0, self.err
        return json.loads(self.out)


class Tests:
    def __init__(self, peelnet):
        self.peelnet = peelnet
        self.folder = tempfile.TemporaryDirectory()
        self.server = Server()
        self.s3 = self.server.client()
        self.s3.create_bucket(Bucket="rows")
        whole = self.run(self.server.port, f"extract --synthetic {LISTS} --out {self.folder.name}/whole")
        self.whole = whole.json()

    def start(self, port, line, key=KEY, secret=SECRET, worker="here"):
        env = {k: v for k, v in os.environ.items() if not k.startswith("AWS_")}
        env |= {
            "AWS_ACCESS_KEY_ID": key,
            "AWS_SECRET_ACCESS_KEY": secret,
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
            "AWS_ALLOW_HTTP": "true",
            "AWS_REGION": "us-east-1",
            "PEELNET_WORKER": worker,
            "XDG_RUNTIME_DIR": env.get("XDG_RUNTIME_DIR", self.folder.name),
        }
        return subprocess.Popen(
            [self.peelnet, *line.split(), "--json"],
            env=env,
            cwd=self.folder.name,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, port, line, **options):
        process = self.start(port, line, **options)
        out, err = process.communicate(timeout=300)
        for secret in (SECRET, KEY, options.get("secret", SECRET), options.get("key", KEY)):
            assert secret not in out + err, f"a credential is printed: {out}{err}"
        return Run(process.returncode, out, err)

    def extract(self, prefix, port=None, more="", **options):
        port = port or self.server.port
        return self.run(port, f"extract --synthetic {LISTS} --out s3://rows/{prefix} {more}", **options)

    def names(self, prefix):
        found = self.s3.list_objects_v2(Bucket="rows", Prefix=prefix + "/")
        return sorted(o["Key"][len(prefix) + 1 :] for o in found.get("Contents", []))

    def same(self, answer):
        assert answer["sealed"] and answer["hash"] == self.whole["hash"], answer

    def fails(self, run, *words):
        assert run.code == 1, (run.code, run.out, run.err)
        errors = [line for line in run.err.splitlines() if line.startswith("error")]
        assert len(errors) == 1, run.err
        for word in words:
            assert word in errors[0], f"{word!r} is not in: {errors[0]}"

    # The tests.

    def test_the_same_dataset_as_in_a_folder(self):
        proxy = Proxy(self.server.port, lambda *_: None)
        self.same(self.extract("plain", proxy.port).json())
        requests = len(proxy.requests)
        proxy.end()
        rows = [f"fragments-{k:05}-synthetic-v{k}.parquet" for k in range(PARTS)]
        meta = ["manifest.json", "plan.json"] + [f"parts/{k:05}.json" for k in range(PARTS)]
        card = ["README.md", "croissant.json", "picture-00000.png"]
        assert self.names("plain") == sorted(rows + card + ["_peelnet/" + m for m in meta]), self.names("plain")
        for command in ("inspect", "seal"):
            answer = self.run(self.server.port, f"{command} s3://rows/plain").json()
            assert answer["rows"] == self.whole["rows"]
        model = f"{self.folder.name}/m.safetensors"
        self.run(self.server.port, f"train s3://rows/plain --recipe thesis --epochs 1 --out {model}").json()
        # What is there is neither replaced nor written again.
        self.fails(self.extract("plain"), "is not replaced", "--resume")
        again = self.extract("plain", more="--resume").json()
        assert again["parts_written"] == 0
        self.same(again)
        return f"{requests} requests for {PARTS} parts"

    def test_a_folder_by_its_address(self):
        place = f"file://{self.folder.name}/by-address"
        self.same(self.run(self.server.port, f"extract --synthetic {LISTS} --out {place}").json())
        self.run(self.server.port, f"inspect {place}").json()

    def test_two_writers_of_every_part(self):
        line = f"extract --synthetic {LISTS} --out s3://rows/two --resume"
        both = [self.start(self.server.port, line, worker=w) for w in ("a", "b")]
        for process in both:
            out, err = process.communicate(timeout=300)
            assert process.returncode == 0, err
            self.same(json.loads(out))

    def test_two_writers_of_different_bytes(self):
        def hook(method, path, _):
            # Another worker is faster by a moment, and computes differently.
            if method == "PUT" and path.endswith("/parts/00001.json"):
                record = json.loads(self.s3.get_object(Bucket="rows", Key="differ/_peelnet/parts/00000.json")["Body"].read())
                record["worker"], record["part"]["index"] = "node-x", 1
                self.s3.put_object(Bucket="rows", Key="differ/_peelnet/parts/00001.json", Body=json.dumps(record))

        proxy = Proxy(self.server.port, hook)
        run = self.extract("differ", proxy.port, worker="node-y")
        self.fails(run, "part 1", "node-x", "node-y", "different bytes")
        assert "1 of 5 parts stay" in run.err or "2 of 5 parts stay" in run.err, run.err
        proxy.end()

    def test_a_killed_writer(self):
        reached = threading.Event()

        def hook(method, path, _):
            if method == "PUT" and "fragments-00002" in path:
                reached.set()
                time.sleep(2)

        proxy = Proxy(self.server.port, hook)
        process = self.start(proxy.port, f"extract --synthetic {LISTS} --out s3://rows/killed")
        assert reached.wait(100)
        process.kill()
        process.communicate()
        time.sleep(2.5)
        proxy.end()
        records = [n for n in self.names("killed") if "/parts/" in n]
        assert len(records) == 2, records
        self.fails(self.run(self.server.port, "inspect s3://rows/killed"), "3 of 5 parts are missing", "the first is 2")
        self.fails(self.run(self.server.port, "seal s3://rows/killed"), "3 of 5 parts are missing")
        rest = self.extract("killed", more="--resume").json()
        assert rest["parts_written"] == 3
        self.same(rest)

    def test_another_plan(self):
        self.extract("planned").json()
        run = self.run(self.server.port, "extract --synthetic 5001 --out s3://rows/planned --resume", worker="node-b")
        self.fails(run, "number of lists is 5000", "here", "node-b")

    def test_throttling(self):
        seen = {}

        def hook(method, path, _):
            # Every request is refused twice.
            seen[method, path] = seen.get((method, path), 0) + 1
            return "slow" if seen[method, path] % 3 != 0 else None

        proxy = Proxy(self.server.port, hook)
        start = time.time()
        self.same(self.extract("throttled", proxy.port).json())
        proxy.end()
        return f"{len(proxy.requests)} requests, {time.time() - start:.1f} s"

    def test_cut_connections(self):
        for when in ("cut-before", "cut-after"):
            proxy = Proxy(self.server.port, lambda _m, _p, n, when=when: when if n % 3 == 0 else None)
            self.same(self.extract(when, proxy.port).json())
            proxy.end()
            self.run(self.server.port, f"inspect s3://rows/{when}").json()

    def test_an_edited_part(self):
        name = "fragments-00001-synthetic-v1.parquet"
        self.extract("edited").json()
        at = {"Bucket": "rows", "Key": f"edited/{name}"}
        body = bytearray(self.s3.get_object(**at)["Body"].read())
        good = bytes(body)
        body[len(body) // 2] ^= 1
        self.s3.put_object(**at, Body=bytes(body))
        self.fails(self.run(self.server.port, "inspect s3://rows/edited"), name, "s3://rows/edited")
        self.s3.put_object(**at, Body=good + b"more")
        self.fails(self.run(self.server.port, "inspect s3://rows/edited"), name, "part 1 of worker here", "bytes")
        self.s3.delete_object(**at)
        self.fails(self.run(self.server.port, "inspect s3://rows/edited"), name, "is missing")
        mended = self.extract("edited", more="--resume").json()
        assert mended["parts_written"] == 1
        self.same(mended)
        self.run(self.server.port, "inspect s3://rows/edited").json()

    def test_a_bucket_that_is_not_there(self):
        for line in (f"extract --synthetic {LISTS} --out", "inspect", "seal"):
            run = self.run(self.server.port, f"{line} s3://nowhere/d")
            self.fails(run, "s3://nowhere/d", "the bucket does not exist")

    def test_addresses_with_a_password(self):
        run = self.run(self.server.port, f"inspect s3://{KEY}:{SECRET.replace('/', '')}@rows/d")
        self.fails(run, "without credentials")
        assert SECRET.replace("/", "") not in run.err

    def test_models(self):
        self.extract("for-models").json()
        place = "s3://rows/models/m.safetensors"
        train = f"train s3://rows/for-models --recipe thesis --epochs 1 --out {place}"
        local = f"{self.folder.name}/local.safetensors"
        answer = self.run(self.server.port, train).json()
        assert answer["out"] == place, answer
        self.run(self.server.port, train.replace(place, local)).json()
        stored = self.s3.get_object(Bucket="rows", Key="models/m.safetensors")["Body"].read()
        assert stored == pathlib.Path(local).read_bytes()
        assert self.names("models") == ["m.safetensors"]
        self.fails(self.run(self.server.port, train), place, "none is replaced")
        first, second = (self.run(self.server.port, f"inspect {m}").json() for m in (place, local))
        assert {k for k in first if first[k] != second[k]} <= {"path", "file", "model"}, (first, second)
        for m, out in ((place, "a.wgsl"), (local, "b.wgsl")):
            self.run(self.server.port, f"export {m} --out {self.folder.name}/{out}").json()
        texts = [pathlib.Path(self.folder.name, out).read_text() for out in ("a.wgsl", "b.wgsl")]
        assert texts[0] == texts[1]
        self.fails(self.run(self.server.port, f"inspect {place.replace('m.safe', 'x.safe')}"), "s3://rows/models/x.safetensors", "cannot read the model")
        # The server is gone when the training ends: the model is kept on this machine.
        proxy = Proxy(self.server.port, lambda method, _p, _n: (403, "AccessDenied") if method == "PUT" else None)
        run = self.run(proxy.port, train.replace("m.safe", "n.safe"))
        proxy.end()
        self.fails(run, "s3://rows/models/n.safetensors", "the account may not do this")
        kept = run.err.split("the model is kept: ")[1].splitlines()[0]
        assert pathlib.Path(kept).read_bytes() == stored

    def test_a_full_bucket_and_a_wrong_clock(self):
        for code, words in (("QuotaExceeded", "full"), ("RequestTimeTooSkewed", "clock")):
            # The first part is written, then nothing more.
            hook = lambda method, path, _n, code=code: (403, code) if method == "PUT" and "/fragments-00002" in path else None
            proxy = Proxy(self.server.port, hook)
            run = self.extract(f"of-{code}", proxy.port)
            proxy.end()
            self.fails(run, "fragments-00002", words, code)
            rest = self.extract(f"of-{code}", more="--resume").json()
            assert rest["parts_written"] == 3, rest
            self.same(rest)

    def test_credentials_and_rights(self):
        server = Server(open_calls=7)
        try:
            iam, s3 = server.client("iam"), server.client()
            keys = {}
            for user, actions in (("writer", ["s3:*"]), ("reader", ["s3:Get*", "s3:List*"])):
                iam.create_user(UserName=user)
                made = iam.create_access_key(UserName=user)["AccessKey"]
                keys[user] = {"key": made["AccessKeyId"], "secret": made["SecretAccessKey"]}
                statement = {"Effect": "Allow", "Action": actions, "Resource": "*"}
                policy = json.dumps({"Version": "2012-10-17", "Statement": [statement]})
                iam.put_user_policy(UserName=user, PolicyName="p", PolicyDocument=policy)
            s3.create_bucket(Bucket="rows")
            self.same(self.extract("d", server.port, **keys["writer"]).json())
            self.run(server.port, "inspect s3://rows/d", **keys["reader"]).json()
            self.fails(self.extract("e", server.port, **keys["reader"]), "s3://rows/e", "the account may not do this", "403")
            for wrong in ({"key": KEY, "secret": SECRET}, {"key": keys["writer"]["key"], "secret": SECRET}):
                self.fails(self.extract("e", server.port, **wrong), "s3://rows/e", "refused the credentials", "403")
                self.fails(self.run(server.port, "inspect s3://rows/d", **wrong), "refused the credentials")
        finally:
            server.end()


def main():
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    tests = Tests(str(pathlib.Path(sys.argv[1]).resolve()))
    failed = 0
    try:
        for name in [n for n in dir(Tests) if n.startswith("test_") and all(w in n for w in sys.argv[2:])]:
            start = time.time()
            try:
                note = getattr(tests, name)()
                print(f"ok     {name} ({time.time() - start:.1f} s){': ' + note if note else ''}", flush=True)
            except Exception as error:  # noqa: BLE001 - every failure is reported, and the others still run
                failed += 1
                print(f"FAILED {name}: {type(error).__name__}: {error}", flush=True)
    finally:
        tests.server.end()
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
