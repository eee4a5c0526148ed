use serde_json::Value;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A scene of two triangles that is drawn in no time.
pub const SCENE: &str = r#"name = "two"
[camera]
position = [0, 0, 3]
target = [0, 0, 0]
up = [0, 1, 0]
fov_y = 45
near = 0.1
far = 10
[[object]]
mesh = { shape = "quad", size = [1, 1] }
[object.material]
color = [0.8, 0.1, 0.1]
alpha = 0.5
"#;

/// Three spheres in two views: up to six layers.
pub const SPHERES: &str = r#"name = "three-spheres"
background = [1.0, 1.0, 1.0]
[camera]
position = [0, 0, 4]
target = [0, 0, 0]
near = 0.1
far = 100.0
[orbit]
views = 2
[[object]]
mesh = { shape = "sphere" }
translate = [0, 0, 0.4]
material = { color = [0.9, 0.1, 0.1], alpha = 0.5, lighting = "unlit" }
[[object]]
mesh = { shape = "sphere" }
translate = [0.3, 0.2, 0]
material = { color = [0.1, 0.8, 0.1], alpha = 0.4, lighting = "unlit" }
[[object]]
mesh = { shape = "sphere" }
translate = [-0.3, 0.1, -0.5]
material = { color = [0.1, 0.2, 0.9], alpha = 0.7, lighting = "unlit" }
"#;

/// A temporary folder in which the program runs.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new(files: &[(&str, &str)]) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, text) in files {
            folder.write(name, text);
        }
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::create_dir_all(self.at(name).parent().unwrap()).unwrap();
        std::fs::write(self.at(name), bytes).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.at(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The file of a network that ships.
    pub fn write_model(&self, name: impl AsRef<Path>, recipe: peelnet::Recipe) {
        let model = peelnet::Model::shipped(recipe).unwrap();
        model.save(self.path().join(name)).unwrap();
    }

    pub fn command(&self, line: &str) -> Command {
        let words: Vec<&str> = line.split_whitespace().collect();
        self.command_of(&words)
    }

    pub fn command_of<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_peelnet"));
        command.args(arguments).current_dir(self.path());
        // Graphics libraries complain on stderr where this is not set, as in containers.
        if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
            command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
        }
        // Plans and records have the name.
        command.env("PEELNET_WORKER", "test");
        command
    }

    /// What a command line said on stderr, which ends with this code.
    pub fn says(&self, line: &str, code: i32) -> String {
        let output = self.command(line).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}: {text}");
        text
    }

    pub fn prints(&self, line: &str) -> String {
        let output = self.command(line).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {text}");
        String::from_utf8(output.stdout).unwrap()
    }

    pub fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.prints(&format!("{line} --json"))).unwrap()
    }

    /// Everything below the folder: what it is, and a hash of what it holds.
    pub fn everything(&self) -> BTreeMap<PathBuf, (String, u64)> {
        let mut found = BTreeMap::new();
        let mut folders = vec![self.path().to_owned()];
        while let Some(next) = folders.pop() {
            for entry in std::fs::read_dir(next).unwrap() {
                let path = entry.unwrap().path();
                let kind = std::fs::symlink_metadata(&path).unwrap().file_type();
                let mut hasher = DefaultHasher::new();
                let what = if kind.is_symlink() {
                    format!("link to {}", std::fs::read_link(&path).unwrap().display())
                } else if kind.is_dir() {
                    folders.push(path.clone());
                    "folder".to_owned()
                } else if kind.is_file() {
                    std::fs::read(&path).unwrap().hash(&mut hasher);
                    "file".to_owned()
                } else {
                    "a device or a pipe".to_owned()
                };
                let name = path.strip_prefix(self.path()).unwrap().to_owned();
                found.insert(name, (what, hasher.finish()));
            }
        }
        found
    }
}

/// The rows of a result, those of one method.
pub fn rows_of<'a>(answer: &'a Value, method: &str) -> Vec<&'a Value> {
    let rows = answer["rows"].as_array().unwrap().iter();
    rows.filter(|row| row["method"] == method).collect()
}
