//! Scenes of many characters are made in parts, and shards of one run merge to what one run makes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// More than come in one part.
const CROWD: usize = 230;

/// Of whom hundreds of files are written while the signal comes.
const THOUSAND: usize = 1000;
/// Who is told to end ends before anybody notices.
const AT_ONCE: Duration = Duration::from_millis(200);

fn cotillion(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
    command.args(arguments).current_dir(folder).output().expect("the program runs")
}

/// People side by side; the last of each hundred and the first of the next walk together, carry something together, and one
/// reaches for the other's hand.
fn crowd(count: usize) -> String {
    let mut text = String::from(
        "title = \"Crowd\"\n[clips]\nwalk = \"builtin:walk,seconds=1.5\"\ncarry = \"builtin:carry\"\n",
    );
    for who in 0..count {
        let clip = if matches!(who, 110 | 120) { "carry" } else { "walk" };
        text += &format!("[[character]]\nname = \"c{who}\"\ntrack = [\"{clip}\"]\n");
        text += &format!("[[pin]]\nat = \"c{who}:start\"\nposition = [0.0, {}.0]\n", 2 * who);
        text += &format!("[[pin]]\nat = \"c{who}:end\"\nposition = [2.{}, {}.0]\n", who % 10, 2 * who);
    }
    for pair in [[99, 100], [7, 215], [228, 3]] {
        let [one, other] = pair;
        text += &format!("[[relative]]\nat = \"c{one}:20\"\nto = \"c{other}:20\"\noffset = [0.0, 2.0]\n");
        text += &format!("[[sync]]\nmoments = [\"c{one}:20\", \"c{other}:20\"]\n");
    }
    text += "[[end_effector]]\nat = \"c40:20\"\njoint = \"right_hand\"\n\
             target = { character = \"c180\", joint = \"head\" }\n";
    text += "[[object]]\nname = \"stone\"\nsize = [0.3, 0.3, 0.3]\nposition = [1.0, -3.0]\n";
    text
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let read = |entry: fs::DirEntry| {
        (entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).expect("a file"))
    };
    entries.map(read).collect()
}

fn without_times(report: &[u8]) -> Value {
    let mut value: Value = serde_json::from_slice(report).expect("a report");
    value["timing_ms"] = Value::Null;
    value
}

#[test]
fn merged_shards_have_the_bytes_of_one_run() {
    let home = tempfile::tempdir().expect("a temporary folder");
    fs::write(home.path().join("crowd.toml"), crowd(CROWD)).expect("a file");
    let run = |arguments: &[&str]| {
        let output = cotillion(arguments, home.path());
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["run", "crowd.toml", "--quiet", "-o", "whole"]);
    let mut merge = vec!["merge", "-o", "merged"];
    let shards = ["1/3", "2/3", "3/3"];
    let folders = ["first", "second", "third"];
    for (shard, folder) in shards.iter().zip(&folders) {
        run(&["run", "crowd.toml", "--quiet", "--shard", shard, "-o", folder]);
        merge.push(folder);
    }
    run(&merge);
    let (whole, merged) = (files(&home.path().join("whole")), files(&home.path().join("merged")));
    assert_eq!(whole.keys().collect::<Vec<_>>(), merged.keys().collect::<Vec<_>>());
    assert_eq!(whole.keys().filter(|name| name.ends_with(".glb")).count(), 3);
    assert!(!whole.keys().any(|name| name.ends_with(".bvh")), "of many characters only on request");
    for (name, bytes) in &whole {
        if name == "report.json" {
            let [whole, merged] = [bytes, &merged[name]].map(|report| without_times(report));
            assert_eq!(whole["characters"].as_array().map(Vec::len), Some(CROWD));
            assert_eq!(
                serde_json::to_string(&whole).expect("text"),
                serde_json::to_string(&merged).expect("text")
            );
        } else {
            assert!(*bytes == merged[name], "{name} differs");
        }
    }
    for folder in folders {
        fs::create_dir_all(home.path().join("all")).expect("a folder");
        fs::rename(home.path().join(folder), home.path().join("all").join(folder)).expect("a name");
    }
    run(&["merge", "all", "-o", "once_more"]);
    assert_eq!(merged, files(&home.path().join("once_more")));
    let refused = |folders: &[&str], what: &str| {
        let output = cotillion(&[&["merge", "-o", "again"], folders].concat(), home.path());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && told.contains(what), "{what}: {told}");
        assert!(!home.path().join("again").exists());
    };
    refused(&["all/first", "all/third"], "these are missing: 2");
    let glb = home.path().join("all/second/scene-2.glb");
    let mut changed = fs::read(&glb).expect("a file");
    let middle = changed.len() / 2;
    changed[middle] ^= 1;
    // Written anew: what was merged may be a link to it.
    fs::remove_file(&glb).and_then(|()| fs::write(&glb, &changed)).expect("a file");
    refused(&["all"], "scene-2.glb was changed");
    fs::write(home.path().join("all/second/scene-2.glb"), "").expect("a file");
    refused(&["all"], "scene-2.glb has 0 bytes in place of");
    fs::remove_file(home.path().join("all/second/scene-2.glb")).expect("a file");
    refused(&["all"], "second/shard-2-of-3.json: error: scene-2.glb cannot be read");
    run(&["run", "crowd.toml", "--quiet", "--bvh-files", "--shard", "2/3", "-o", "all/second"]);
    refused(&["all"], "what was asked for");
}

/// A part holds all whom its members reach; who is drawn, written and told of does not depend on parts.
#[test]
fn parts_change_nothing_of_a_character() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let text = crowd(CROWD);
    fs::write(home.path().join("crowd.toml"), &text).expect("a file");
    let output = cotillion(&["run", "crowd.toml", "--quiet", "--bvh-files", "-o", "parts"], home.path());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let made = files(&home.path().join("parts"));
    assert_eq!(made.keys().filter(|name| name.ends_with(".bvh")).count(), CROWD);

    let loaded =
        cotillion::scene::load_text(&text, Path::new("crowd.toml"), &Default::default()).expect("sound");
    let mut editor = cotillion::edit::Editor::new(loaded.scene).expect("regular");
    let edit = editor.solve().expect("a solution").clone();
    let mut resampled = cotillion::resample::resample(editor.scene(), &edit).expect("short");
    cotillion::embody::embody(editor.scene(), &edit, &mut resampled);
    let options = cotillion::export::bvh::BvhOptions::default();
    for who in [0, 7, 40, 99, 100, 180, 215, 229] {
        let alone = cotillion::export::bvh::to_bvh_with(&resampled.clips[who], &options);
        assert!(alone.as_bytes() == made[&format!("c{who}.bvh")], "c{who}");
    }
}

/// A run of a thousand whose files are being written, in `deep/result` of a folder.
#[cfg(unix)]
fn writing(home: &Path) -> std::process::Child {
    fs::write(home.join("crowd.toml"), crowd(THOUSAND)).expect("a file");
    let mut running = Command::new(env!("CARGO_BIN_EXE_cotillion"))
        .args(["run", "crowd.toml", "--quiet", "--bvh-files", "-o", "deep/result"])
        .current_dir(home)
        .stdin(Stdio::null())
        .spawn()
        .expect("the program runs");
    let patience = Instant::now() + Duration::from_secs(60);
    // Files are put aside in a folder of their own: some are there, and most are not.
    let aside = || fs::read_dir(home.join("deep/result")).ok()?.flatten().next().map(|entry| entry.path());
    let is_writing =
        || aside().and_then(|aside| fs::read_dir(aside).ok()).is_some_and(|files| files.count() > 3);
    while !is_writing() && Instant::now() < patience && running.try_wait().expect("a child").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    running
}

#[cfg(unix)]
fn told(signal: &str, running: &std::process::Child) {
    let told = Command::new("kill").args([signal, &running.id().to_string()]).status().expect("a signal");
    assert!(told.success(), "it was still running");
}

#[cfg(unix)]
#[test]
fn who_is_interrupted_leaves_nothing() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let mut running = writing(home.path());
    told("-INT", &running);
    let since = Instant::now();
    let status = running.wait().expect("it ends");
    assert!(since.elapsed() < AT_ONCE, "it took {:?}", since.elapsed());
    assert_eq!(status.code(), Some(130));
    assert!(!home.path().join("deep").exists(), "nothing is left");
    // What was aside is out of the way, and removed by another process.
    let patience = Instant::now() + Duration::from_secs(60);
    let count = || fs::read_dir(home.path()).expect("a folder").count();
    while count() > 1 && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(count(), 1, "the scene and nothing else");
}

#[cfg(unix)]
#[test]
fn what_a_killed_run_left_is_removed_by_the_next_and_nothing_of_one_that_runs() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let mut running = writing(home.path());
    let left = || {
        let names = fs::read_dir(home.path().join("deep/result")).expect("a folder").flatten();
        names.filter(|entry| entry.file_name().to_string_lossy().starts_with(".cotillion-")).count()
    };
    let relay = ["relay", "-n", "2", "-o", "deep/result/relay.toml"];
    assert!(cotillion(&relay, home.path()).status.success());
    assert!(left() == 1 || running.try_wait().expect("a child").is_some(), "it is in use");
    told("-KILL", &running);
    running.wait().expect("it ends");
    assert_eq!(left(), 1);
    assert!(cotillion(&relay, home.path()).status.success());
    assert_eq!(left(), 0);
}
