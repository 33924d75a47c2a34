//! The house plan holds: a module uses only modules above it, and one file names each numerical library.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All Rust files below `folder`, or `folder.rs` itself.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let alone = folder.with_extension("rs");
    found.extend(alone.is_file().then_some(alone));
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// Modules that the file `declaring` declares, in its order.
fn modules(declaring: &Path) -> Vec<String> {
    let declared = |line: &str| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned());
    read(declaring).lines().filter_map(declared).collect()
}

/// Names that follow `prefix` in the code of `path`, tests left out.
fn used(path: &Path, prefix: &str) -> Vec<String> {
    let text = read(path);
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let name = |rest: &str| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    lines.flat_map(|line| line.split(prefix).skip(1).map(name).collect::<Vec<_>>()).collect()
}

fn assert_ordered(modules: &[String], folder: &Path, prefix: &str) {
    assert!(modules.len() > 5, "the order of modules is found");
    let place = |name: &str| modules.iter().position(|module| module == name);
    for (own, module) in modules.iter().enumerate() {
        for path in files(&folder.join(module)) {
            for name in used(&path, prefix) {
                let used = place(&name).unwrap_or(0);
                assert!(used <= own, "{} uses {prefix}{name}, which comes later", path.display());
            }
        }
    }
}

#[test]
fn modules_use_only_modules_above_them() {
    let src = root().join("src");
    assert_ordered(&modules(&src.join("lib.rs")), &src, "crate::");
}

#[test]
fn steps_of_the_edit_use_only_steps_above_them() {
    let edit = root().join("src/edit");
    assert_ordered(&modules(&edit.join("mod.rs")), &edit, "crate::edit::");
}

#[test]
fn one_file_names_the_linear_algebra_library() {
    for path in files(&root().join("solvers/src")).into_iter().chain(files(&root().join("src"))) {
        let named = used(&path, "faer::").len();
        let allowed = path.ends_with("solvers/src/lu.rs");
        assert!(named == 0 || allowed, "{} names faer", path.display());
        assert!(!allowed || named > 0, "lu.rs names it");
    }
}

#[test]
fn one_module_names_the_graph_library() {
    let graph = root().join("src/graph");
    let named = |path: &PathBuf| !used(path, "petgraph::").is_empty();
    for path in files(&root().join("src")) {
        assert!(path.starts_with(&graph) || !named(&path), "{} names petgraph", path.display());
    }
    assert!(files(&graph).iter().any(named), "the motion graph names it");
}

#[test]
fn one_file_names_the_quadratic_solver() {
    for path in files(&root().join("src")) {
        let is_named = !used(&path, "clarabel::").is_empty();
        assert_eq!(is_named, path.ends_with("src/quadratic.rs"), "{}", path.display());
    }
}

#[test]
fn only_the_rim_reads_writes_and_looks_at_the_clock() {
    let rim = [
        "src/scene",
        "src/export",
        "src/cli",
        "src/main.rs",
        "src/studio",
        "src/clip/file.rs",
        "src/graph_cache.rs",
    ]
    .map(|path| root().join(path));
    for path in files(&root().join("src")) {
        if rim.iter().any(|folder| path.starts_with(folder)) {
            continue;
        }
        let code = read(&path);
        for word in ["std::fs", "std::io", "std::time", "std::env::var"] {
            assert!(!code.contains(word), "{} uses {word}", path.display());
        }
    }
}
