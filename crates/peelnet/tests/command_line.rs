//! The program itself: what it refuses, with which exit code and which words, and what it answers.

use crate::common::{Folder, SCENE};

#[test]
fn help_and_version_go_to_stdout() {
    let folder = Folder::new(&[]);
    for line in ["--help", "--version", "help extract", "doctor --help"] {
        let output = folder.command(line).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}");
        assert!(!output.stdout.is_empty() && output.stderr.is_empty());
    }
    let text = folder.prints("extract --help");
    assert!(text.contains("Examples:") && text.contains("--adapter"));
    let output = folder.command("").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty() && !output.stderr.is_empty());
}

/// Command lines that are wrong by themselves: exit code 2.
const WRONG_USAGE: &str = "
    no-such-command
    doctor --frobnicate
    extract --out d
    extract two.toml
    extract two.toml --out d --size 0x4
    extract two.toml --out d --size big
    extract two.toml --out d --views 0
    extract two.toml --out d --pixels 2
    extract two.toml --out d --shard 5/4
    extract two.toml --out d --shard 0/4
    extract --synthetic 99999999999 --out d
    extract two.toml --out d --format xml
    extract two.toml --out d --peel onion
    extract two.toml --out d --preview --resume
    extract two.toml --out d --preview --shard 1/2
    extract --synthetic 9 --out d --preview
    train sound --out m --recipe huge
    train sound --out m --loss-curve loss.png
    train sound --out m --epochs 0
    train sound --out m --epochs 4294967295
    train sound --out m --batch 4294967295
    train sound --out m --hidden 1000000000,8
    train sound --out m --max-rows 0
    train sound --out m --lr -1
    train sound --out m --split pixels
    train sound --out m --schedule cosine
    run two.toml --out r --epochs 10000000
    export m.safetensors --out w --lang cuda
    export m.safetensors --out w --lang spirv
    export m.safetensors --out w --precision f64
    render two.toml --out a.gif
    render two.toml --out a.png --method wbiot
    render two.toml --out a.png --method abuffer:speed=9
    render two.toml --out a.png --method mboit4:bias=9
    render two.toml --out a.png --method mboit4:bias=0,bias=1
    render two.toml --out a.png --method wboit-eq9 --highlight 1
    render two.toml --out a.png --method wboit-eq9 --increasing
    render two.toml --out a.png --samples 4 --layers printed
    train d --recipe small --max-rows 5 --buffer-rows 5 --out m.safetensors
    render two.toml --out a.png --increasing
    render two.toml --out a.png --layers printed
    render two.toml --out a.png --highlight 1 --layers ours
    render two.toml --out a.png --samples 8
    bench two.toml --out d --methods mboit4:bios=1
    bench effects two.toml --out d --samples 4
    bench path two.toml --out d --frames 0
    bench effects two.toml --out d --frames 0
    bench scaling --out d --frames 0
    bench redraw two.toml --out d
    bench two.toml --out d --samples 2
    stress --methods mboit4:overestimation=-5
    stress --cases shallow";

/// Exit code, command line, and words of the one error: what is wrong, where, and what to do about it.
const REFUSED: &str = "
    2 | render two.toml --out a.png --view 1 | has 1 view,
    2 | render two.toml --out a.png --highlight 3 | --highlight 3
    2 | render two.toml --out a.png --adapter nothing | nothing
    2 | render two.toml --out a.png --time 3 | timeline
    2 | extract two.toml --out d --size 8x8 --views 5 | 1 of the 5 views
    2 | extract two.toml --out d --augment 4294967295 | at most 65536 & --augment
    2 | extract two.toml two.toml --out d | rename one
    1 | extract stained.toml --out d | transmission_color
    2 | bench two.toml two.toml --out b | named 'two' & two.toml) & rename one
    1 | bench path two.toml --frames 1000 --methods abuffer --out b | 1000 frames of 1024x768 & --size
    2 | bench designs own two.toml --out b | own: & scene 'two' & without it
    1 | bench designs own nan.toml --file designs.toml --out b | designs.toml & design 1 (\"short\") & must end at 1
    2 | inspect notes.txt | notes.txt
    1 | render two.toml --out a.png --size 100000x100000 | needs 100000 pixels a side

    2 | render cups --out a.png --method depth_peel | no method 'depth_peel' & did you mean
    2 | render cups --out a.png --method mboit | did you mean mboit4
    1 | render cup --out a.png | cup: is no file and no shipped scene; did you mean cups
    1 | render notes.txt --out a.png | notes.txt: is no scene & .gltf
    1 | render m.safetensors --out a.png | m.safetensors: is a network; name a scene file
    1 | render sound --out a.png | sound: is a folder, such as a dataset; name a scene file
    1 | train two.toml --out m | two.toml: is a file, and a dataset is a folder & peelnet extract
    1 | export sound --out w.wgsl | sound: is a folder, and a network is a file & peelnet train
    1 | train edited --out m | edited: the manifest and the plan say different things & peelnet extract
    1 | bench two.toml --views 7 --methods blended --out b | two.toml has 1 of the 7 views
    1 | bench two.toml --methods blended --out s3://bucket/b | is an address; name a folder
    1 | train nowhere --out m | nowhere: there is no such dataset & peelnet extract
    2 | train sound --out m --lr 1e30 | below 10
    2 | train sound --out m --hidden 1 | widths from 2
    2 | inspect two.toml --html a.html | two.toml: --html is for a dataset
    2 | inspect m.safetensors --html a.html | m.safetensors: --html is for a dataset
    1 | inspect missing --html a.html | missing: there is no such file
    2 | inspect sound --html sound/a.html | --html sound/a.html & dataset
    1 | inspect sound --html notes.txt | --html notes.txt & --force
    1 | inspect cut --html a.html | cut/fragments-00000-synthetic-v0.csv
    2 | extract two.toml --out own --preview | --out own/preview.html & dataset
    1 | extract two.toml --out own-preview --preview | preview.html & not a report of peelnet & --force
    1 | extract two.toml --out s3://bucket/p --preview | is an address; name a folder
    2 | extract two.toml --out p --size 8x8 --views 5 --preview | 1 of the 5 views
    1 | extract stained.toml --out p --size 8x8 --preview | transmission_color
    2 | inspect sound --time | sound: --time measures a scene's effects
    2 | inspect two.toml --files-from nowhere | --files-from nowhere: is no folder
    2 | train sound --out m --lr 1e-30 | learning_rate & --lr
    2 | export m.safetensors --out w.hlsl --lang msl | --out w.hlsl: the ending says hlsl, --lang says msl & .metal
    1 | export m.safetensors --out other.glsl | --out other.glsl: the description beside it is that of another network's other.wgsl
    2 | bench two.toml --methods blended,blended --out b | blended is named twice
    2 | stress --methods blended,blended | blended is named twice
    1 | train sound sound --out m --recipe thesis | sound and sound hold the same rows
    1 | render utf16.toml --out a.png | utf16.toml: is no text in UTF-8
    1 | inspect spy/spy.gltf | secret.txt & lies outside of the folder & --files-from

    1 | render missing.toml --out a.png | missing.toml
    1 | run missing.toml --out b | missing.toml
    1 | inspect missing | missing
    1 | inspect folder | folder
    1 | train folder --out m | folder
    1 | train missing --out m | missing
    1 | train own --out m | own: & method deep-medium draws every pixel exactly & recipe thesis
    1 | export missing.safetensors --out w.wgsl | missing.safetensors
    1 | export cups --out w.wgsl | cups: there is no such file & `peelnet train` wrote
    2 | render two.toml --out a.png --view -1 | invalid value '-1' for '--view
    2 | bench two.toml --methods wboit-eq9,wboit-eq9:targets=f16 --out b | wboit-eq9 and wboit-eq9:targets=f16 are one method
    2 | stress --methods wboit-eq10:factor=3e3,wboit-eq10:factor=3000 | are one method

    1 | render key.toml --out a.png | key.toml
    1 | inspect key.toml | key.toml
    1 | render texture.toml --out a.png | cut.png
    1 | render nan.toml --out a.png | nan.obj:5 & 'v 0 nan 0' holds no finite numbers & repair
    1 | train cut --out m | cut/fragments-00000-synthetic-v0.csv & bytes
    1 | inspect text.safetensors | text.safetensors
    1 | export cut.safetensors --out w.wgsl | cut.safetensors

    2 | export m.safetensors --out m.safetensors | --out m.safetensors
    2 | export m.safetensors --out ./sound/../m.safetensors | --out
    1 | export m.safetensors --out two.toml | --out two.toml
    1 | render two.toml --out notes.png | --out notes.png & --force
    2 | render two.toml --out hard.png | --out hard.png
    2 | render reads.toml --out own.png | own.png & which a scene of this command reads
    2 | bench images.toml --methods wboit-eq9 --out ours | c.png & which a scene of this command reads
    2 | render aged.toml --out own.png | own.png & which a scene of this command reads
    2 | train sound --out sound/_peelnet/manifest.json | --out & lies in the dataset & sound; choose a place outside
    2 | train sound --out n --loss-curve sound/new.csv | --loss-curve & lies in the dataset
    1 | train sound --out file://DIR/sound/m | lies in the dataset
    2 | render two.toml --out sound/a.png --force | --out sound/a.png: lies in the dataset
    1 | extract two.toml --out sound/sub | sound/sub: lies in the dataset
    1 | extract two.toml --out file://DIR/sound/sub | lies in the dataset
    1 | extract two.toml --out sound/_peelnet/parts/zz --resume | lies in the dataset
    1 | extract two.toml --out file:DIR/new | an address of a folder is file:///path
    1 | train sound --out file:DIR/m | is file:///path
    1 | render two.toml --out file:DIR/a.png | is no file of this machine
    2 | train sound --out n.svg --loss-curve n.svg | --loss-curve n.svg
    2 | train sound --out n --loss-curve n/loss.csv | --loss-curve n/loss.csv & on the way
    1 | extract two.toml --out kept | kept/fragments-00000-two-v0.parquet & is read-only
    1 | train sound --out two.toml | --out two.toml
    1 | train sound --out old | last.safetensors
    1 | train sound --out Cargo | Cargo.lock
    1 | bench two.toml --out own-page | report.html & --force
    1 | bench two.toml --out own-results | results.json & --force
    1 | bench two.toml --out own-rows | results.csv & --force
    1 | bench two.toml --out own-table | table.md & --force
    1 | bench two.toml --out own-chart | pareto.svg & --force
    1 | bench two.toml --out own-image | holiday.png & --force

    1 | extract orbit.toml --size 16x16 --out shard --shard 2/2 | size is 16x12 & worker test & use the same command
    1 | extract orbit.toml --size 16x12 --out shard --seed 9 --resume | seed is 1 & use the same command & or leave out --resume
    2 | extract orbit.toml --size 16x12 --out shard --max-passes 2 --resume | no passes to limit & --peel dual
    1 | extract orbit.toml --size 16x12 --out shard --views 1 --resume | list of cameras is
    1 | extract two.toml --size 16x12 --out shard --resume | scene 0 is
    1 | extract orbit.toml --size 16x12 --out shard --format npy --shard 2/2 | format is parquet
    1 | extract --synthetic 100 --out shard --resume | adapter class is

    1 | render two.toml --out new.png/ | new.png/: cannot be written: is a directory
    1 | train sound --out new/ | --out new/: cannot be written: is a directory
    1 | render two.toml --out locked.png | locked.png & is read-only & --force
    1 | render two.toml --out foreign.exr | foreign.exr & not an EXR image of peelnet
    1 | render two.toml --out two.toml/a.png | two.toml/a.png
    1 | render two.toml --out folder.png | folder.png: cannot be written: is a directory
    1 | train sound --out m --loss-curve notes.txt/loss.csv | --loss-curve & notes.txt
    1 | train sound --out notes.txt/m | --out & notes.txt
    1 | stress --cases deep --methods wboit-eq9 --out notes.txt | --out notes.txt
    1 | bench scaling --out notes.txt/b | --out & notes.txt
    1 | bench effects --out notes.txt | --out notes.txt
    1 | extract two.toml --out notes.txt | --out notes.txt
    1 | run two.toml --out notes.txt | --out notes.txt
    2 | extract two.toml --out - | name a folder
    2 | bench two.toml --out - | name a folder
    2 | stress --out - | name a folder
    2 | run two.toml --out - | name a folder";

/// Links, devices, and a folder in which nobody may write, not even root.
#[cfg(target_os = "linux")]
const ON_LINUX: &str = "
    1 | render two.toml --out link.png | link.png & is a link
    2 | render two.toml --out /dev/null | the ending says the format
    1 | export m.safetensors --out link.wgsl | link.wgsl & is a link
    1 | export m.safetensors --out /dev/null --force | /dev/null & no regular file
    1 | train sound --out link | --out link & is a link
    1 | train sound --out /dev/stdout | /dev/stdout & is a link
    1 | train sound --out m --loss-curve link.csv | link.csv & is a link
    1 | bench two.toml --out linked | results.json & is a link
    1 | stress --out linked | stress.json & is a link
    1 | run two.toml --out linked | results.json & is a link
    1 | extract two.toml --out /proc/o --size 32x24 | /proc/o
    1 | train sound --out /proc/o/m.safetensors --epochs 1 | /proc/o
    1 | export m.safetensors --out /proc/o.wgsl | /proc/o
    1 | render two.toml --out /proc/o.png --size 32x24 | /proc/o
    1 | bench two.toml --out /proc/o | /proc/o
    1 | stress --methods blended --cases empty --out /proc/o | /proc/o
    1 | run two.toml --out /proc/o | /proc/o";
#[cfg(not(target_os = "linux"))]
const ON_LINUX: &str = "";

/// Files that a user wrote, some of which are called as ours are.
const FOREIGN: &str = "
    notes.txt notes.png folder/notes.txt folder.png/notes.txt old.checkpoint/last.safetensors
    own-page/report.html own-preview/preview.html own-results/results.json own-rows/results.csv own-table/table.md
    own-chart/pareto.svg own-image/images/holiday.png";

/// A mesh that would show what a file elsewhere holds.
const SPY: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "buffers": [{"byteLength": 48, "uri": "../secret.txt"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}"#;

/// Files that are sound, broken in one place each, and a user's own.
fn folder() -> Folder {
    let folder = Folder::new(&[
        ("two.toml", SCENE),
        ("orbit.toml", &format!("{SCENE}[orbit]\nviews = 2\n")),
        ("Cargo.lock", "version = 4"),
        ("key.toml", "name = \"a\"\nspeed = 3\n"),
        (
            "stained.toml",
            &format!("{SCENE}transmission_color = [0.9, 0.1, 0.2]\n"),
        ),
        (
            "nan.obj",
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 nan 0\nf 1 2 3\n",
        ),
        ("text.safetensors", "this is not a model"),
        (
            "designs.toml",
            "[training]\nepochs = 2\nlearning_rate = 0.016\n[[design]]\nname = \"short\"\nends = [0.2, 0.6, 0.9]\n\
             means = [true, true, true]\nfarthest = [true, false, false]\n",
        ),
    ]);
    for name in FOREIGN.split_whitespace() {
        folder.write(name, "a user's own");
    }
    folder.write("cut.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR");
    let (camera, _) = SCENE.split_once("[[object]]").unwrap();
    let scene = format!("{camera}[[object]]\nmesh = 'nan.obj'\n");
    folder.write("nan.toml", scene);
    folder.prints("extract --synthetic 40 --format csv --out sound");
    folder.prints("extract two.toml --size 24x16 --out own");
    folder.prints("extract two.toml --size 24x16 --out edited");
    let manifest = String::from_utf8(folder.read("edited/_peelnet/manifest.json")).unwrap();
    let edited = manifest.replace("\"held_out\": false", "\"held_out\": true");
    folder.write("edited/_peelnet/manifest.json", edited);
    folder.prints("extract orbit.toml --size 16x12 --out shard --shard 1/2");
    folder.prints("extract --synthetic 40 --format csv --out cut");
    let rows = "cut/fragments-00000-synthetic-v0.csv";
    let whole = folder.read(rows);
    folder.write(rows, &whole[..whole.len() / 2]);
    folder.write_model("m.safetensors", peelnet::Recipe::SMALL);
    let model = folder.read("m.safetensors");
    folder.write("cut.safetensors", &model[..model.len() / 2]);
    folder.write_model("other.safetensors", peelnet::Recipe::THESIS);
    folder.prints("export other.safetensors --out other.wgsl");
    folder.prints("render two.toml --size 8x8 --out locked.png");
    folder.prints("extract two.toml --size 8x8 --out kept");
    for locked in ["locked.png", "kept/fragments-00000-two-v0.parquet"] {
        let mut mode = std::fs::metadata(folder.at(locked)).unwrap().permissions();
        mode.set_readonly(true);
        std::fs::set_permissions(folder.at(locked), mode).unwrap();
    }
    folder.write("foreign.exr", b"\x76\x2f\x31\x01\x02\0\0\0a user's own");
    folder.write("secret.txt", [b's'; 64]);
    folder.write("utf16.toml", b"\xff\xfen\0");
    folder.write("spy/spy.gltf", SPY);
    // Our own images, which may be replaced elsewhere, are textures of scenes.
    folder.prints("render two.toml --size 8x8 --out own.png");
    folder.write("ours/images/c.png", folder.read("own.png"));
    for (scene, texture) in [
        ("texture.toml", "cut.png"),
        ("reads.toml", "own.png"),
        ("images.toml", "ours/images/c.png"),
    ] {
        folder.write(scene, format!("{SCENE}color_map = \"{texture}\"\n"));
    }
    let states = "[[timeline]]\ntime = 0\n[[timeline]]\ntime = 9\n[[timeline.object]]\nname = 'a'\nmaterial = { color_map = 'own.png' }\n";
    let aged = SCENE.replace("[[object]]", "[[object]]\nname = 'a'") + states;
    folder.write("aged.toml", aged);
    std::fs::hard_link(folder.at("two.toml"), folder.at("hard.png")).unwrap();
    #[cfg(unix)]
    {
        std::fs::create_dir(folder.at("linked")).unwrap();
        let links = "link.png link.wgsl link link.csv linked/results.json linked/stress.json";
        for link in links.split(' ') {
            std::os::unix::fs::symlink("own.png", folder.at(link)).unwrap();
        }
    }
    folder
}

/// Whatever is refused: the exit code, one line with these words, nothing on stdout, and no file is changed, left or made.
#[test]
fn what_is_refused_says_why_and_changes_nothing() {
    let folder = folder();
    let before = folder.everything();
    let lines = |text: &'static str| text.lines().map(str::trim).filter(|line| !line.is_empty());
    let wrong = lines(WRONG_USAGE).map(|line| ("2", line, ""));
    let refused = lines(REFUSED).chain(lines(ON_LINUX)).map(|row| {
        let mut fields = row.splitn(3, " | ");
        let mut field = || fields.next().unwrap();
        (field(), field(), field())
    });
    for (code, line, words) in wrong.chain(refused) {
        let line = &line.replace("DIR", &folder.path().to_string_lossy());
        let output = folder.command(line).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        let found = output.status.code().map(|code| code.to_string());
        assert_eq!(found.as_deref(), Some(code), "{line}: {text}");
        assert!(output.stdout.is_empty(), "{line}");
        let errors: Vec<&str> = text.lines().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "{line}: {text}");
        for word in words.split(" & ") {
            assert!(errors[0].contains(word), "{line}: no '{word}' in {text}");
        }
        // Plurals, names of types and of temporary files, what a decoder says, and what was joined twice.
        for not in [" 1 views", "::", ".peelnet-", "Chunk", ";;", "100000 bytes"] {
            assert!(!text.contains(not), "{line}: {text}");
        }
        for path in ["two.toml/a.png", "folder.png", "cut.png"] {
            assert!(text.matches(path).count() <= 1, "{path} twice: {text}");
        }
        assert_eq!(folder.everything(), before, "{line}");
    }
}

#[test]
fn flags_that_became_commands_say_so() {
    let folder = Folder::new(&[]);
    let help = folder.prints("bench --help");
    for (flag, command) in [
        ("path", "path SCENE"),
        ("scaling", "scaling"),
        ("effects", "effects"),
        ("designs", "designs DATASET SCENE"),
        ("redraw", "redraw"),
    ] {
        let text = folder.says(&format!("bench --{flag} cups --out d"), 2);
        let tip = format!("--{flag} is a command now: peelnet bench {command} --out DIR");
        assert!(text.contains(&tip), "{text}");
        assert!(!help.contains(&format!("--{flag}")), "{help}");
    }
    assert!(!folder.at("d").exists());
}

/// With or without a driver, `doctor --json` is JSON, and its exit code says whether an adapter can be used.
#[test]
fn doctor_answers_in_json() {
    let folder = Folder::new(&[]);
    assert!(folder.says("doctor --adapter abacus", 2).contains("abacus"));
    let output = folder.command("doctor --json").output().unwrap();
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let usable = answer["used"].is_string();
    assert_eq!(output.status.code(), Some(i32::from(!usable)));
    let has_none = answer["adapters"] == serde_json::json!([]);
    assert_eq!(answer["install"].is_string(), has_none);
}

/// Fifty layers over the whole frame would take a CPU seconds.
#[test]
fn inspect_counts_many_layers_in_a_small_frame() {
    let (camera, object) = SCENE.split_at(SCENE.find("[[object]]").unwrap());
    let object = object.replace("[1, 1]", "[9, 9]");
    let many = format!("{camera}{}", object.repeat(50));
    let folder = Folder::new(&[("two.toml", SCENE), ("many.toml", &many)]);
    for (line, [width, height], layers) in [
        ("inspect two.toml", [1024, 768], 1),
        ("inspect many.toml", [64, 48], 50),
    ] {
        let answer = folder.json(line);
        let frame = serde_json::json!({"view": 0, "width": width, "height": height});
        assert_eq!(answer["counted_at"], frame, "{line}");
        assert_eq!(answer["max_layers"], layers, "{line}");
    }
    // Each of so many parts is a draw.
    let scatter = "[[scatter]]\ncount = 32769\nmesh = { shape = \"quad\" }\nmin = [0, 0, 0]\nmax = [0, 0, 0]\n";
    folder.write("parts.toml", format!("{camera}{scatter}"));
    let said = folder.says("inspect parts.toml", 0);
    assert!(said.contains("the scene has 32,769 parts"), "{said}");
}

/// The shipped vase: each layer highlighted at a time of its own, what there is not is refused, and `inspect` and the measurement of
/// effects list what it needs.
#[test]
fn the_vase_shows_its_layers_and_its_age() {
    let folder = Folder::new(&[]);
    let mut pictures: Vec<Vec<u8>> = Vec::new();
    for (flags, method) in [
        ("--highlight 0 --time 0", "layer 0"),
        ("--highlight 1 --time 55 --increasing", "layer 1"),
        ("--time 55", "abuffer"),
        (
            "--highlight 1 --time 40 --layers printed",
            "layer 1 (formula as printed)",
        ),
    ] {
        let answer = folder.json(&format!("render vase --size 64x48 --out a.png {flags}"));
        assert_eq!(answer["method"], method, "{flags}");
        assert!(answer["time"].is_number(), "{flags}");
        let picture = folder.read("a.png");
        assert!(!pictures.contains(&picture), "{flags}: like an earlier one");
        pictures.push(picture);
    }
    for (flags, word) in [
        ("--highlight 9", "[0, 1, 2]"),
        ("--time 61", "from 0 to 60"),
    ] {
        let text = folder.says(&format!("render vase --out no.png {flags}"), 2);
        assert!(text.contains(word), "{text}");
    }
    assert!(!folder.at("no.png").exists());
    let answer = folder.json("inspect vase");
    let effects = answer["effects"].as_array().unwrap();
    for (names, on) in [
        ("layers ageing pbr normal-map", true),
        ("cutout monochrome", false),
    ] {
        let has = |name| effects.iter().any(|e| e["name"] == name && e["on"] == on);
        assert!(names.split(' ').all(has), "{names}");
    }
    let answer = folder.json("bench effects mist --size 32x24 --frames 1 --out e");
    // Unlit: nothing is shaded that could be left out.
    assert_eq!(answer["parts"].as_array().map(Vec::len), Some(0));
    let costs = answer["costs"].as_array().unwrap().iter();
    let names: Vec<&str> = costs.filter_map(|c| c["effect"].as_str()).collect();
    assert_eq!(names, ["opaque", "monochrome", "low-resolution"]);
    let page = String::from_utf8(folder.read("e/report.html")).unwrap();
    assert!(page.matches("data:image/png").count() == 6 && page.contains("low-resolution"));
}
