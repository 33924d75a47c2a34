//! Costs of an edit: assembling and factoring once, then dragging, by frames and by characters.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use cotillion::clip::builtin::generate;
use cotillion::clip::read::{Capture, ReadOptions, read};
use cotillion::edit::{Backend, Editor, Target};
use cotillion::export::bvh::to_bvh;
use cotillion::geometry::c64;
use cotillion::index::ConstraintId;
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load_text};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// A chain of walkers of `frames` working frames each, everybody tied to the one before at mid-track.
fn chain(characters: usize, frames: usize) -> Scene {
    let seconds = (frames - 1) as f64 / 30.0;
    let mut text = format!("[clips]\nwalk = {{ builtin = \"walk\", seconds = {seconds:?} }}\n");
    for own in 0..characters {
        let _ = write!(
            text,
            "[[character]]\nname = \"c{own}\"\ntrack = [\"walk\"]\nposition = [0.0, {}.0]\nfacing = 0.0\n\
             [[pin]]\nat = \"c{own}:start\"\nposition = [0.0, {own}.0]\n\
             [[pin]]\nat = \"c{own}:end\"\nposition = [9.0, {own}.5]\n",
            2 * own
        );
        if own > 0 {
            let (before, middle) = (own - 1, frames / 2);
            let _ = write!(
                text,
                "[[relative]]\nat = \"c{own}:{middle}\"\nto = \"c{before}:{middle}\"\noffset = [0.0, 1.0]\nfacing = 0.0\n\
                 strength = \"hard\"\n[[sync]]\nmoments = [\"c{own}:{middle}\", \"c{before}:{middle}\"]\nstrength = \"hard\"\n"
            );
        }
    }
    load_text(&text, Path::new("bench.toml"), &ClipFolders::default()).expect("a sound scene").scene
}

/// Axis and parameter of a bench, characters, frames of each.
type Size = (&'static str, usize, usize, usize);

fn sizes() -> [Size; 8] {
    [
        ("frames", 200, 1, 200),
        ("frames", 1_000, 1, 1_000),
        ("frames", 10_000, 1, 10_000),
        ("characters", 4, 4, 200),
        ("characters", 16, 16, 200),
        ("characters", 64, 64, 200),
        ("characters", 256, 256, 200),
        ("characters", 1_000, 1_000, 200),
    ]
}

fn assemble_and_factor(criterion: &mut Criterion) {
    for stage in ["assemble", "factor"] {
        let mut group = criterion.benchmark_group(stage);
        group.sample_size(10);
        for (axis, parameter, characters, frames) in sizes() {
            let scene = chain(characters, frames);
            group.throughput(Throughput::Elements((characters * frames) as u64));
            let name = BenchmarkId::new(axis, parameter);
            if stage == "assemble" {
                group.bench_function(name, |b| {
                    b.iter_batched(
                        || scene.clone(),
                        |scene| Editor::assemble(scene, Backend::default()),
                        BatchSize::LargeInput,
                    );
                });
            } else {
                let assembled = || Editor::assemble(scene.clone(), Backend::default());
                let factor = |mut editor: Editor| editor.factor().expect("a regular system");
                group.bench_function(name, |b| b.iter_batched(assembled, factor, BatchSize::LargeInput));
            }
        }
        group.finish();
    }
}

/// Drags the end of the first track.
fn drag(criterion: &mut Criterion, group: &str, backend: Backend, sizes: &[Size]) {
    let mut group = criterion.benchmark_group(group);
    group.sample_size(20);
    for (axis, parameter, characters, frames) in sizes.iter().copied() {
        let mut editor = Editor::assemble(chain(characters, frames), backend);
        let mut step = 0.0;
        group.throughput(Throughput::Elements((characters * frames) as u64));
        group.bench_function(BenchmarkId::new(axis, parameter), |b| {
            b.iter(|| {
                step += 0.01;
                let target = Target::Position(c64::new(9.0 + f64::sin(step), 1.0));
                editor.move_target(ConstraintId(1), target).expect("the end of the first track");
                editor.solve().expect("an answer").energy.total
            });
        });
    }
    group.finish();
}

fn drag_update(criterion: &mut Criterion) {
    drag(criterion, "drag_update", Backend::Reduced, &sizes());
    // The reference, where it does not take minutes.
    drag(criterion, "drag_update_direct", Backend::Direct, &sizes()[..6]);
}

fn clips(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bvh");
    group.sample_size(10);
    let parameters = BTreeMap::from([("seconds".to_owned(), 333.3)]);
    let clip = generate("walk", &parameters).expect("a known clip");
    let text = to_bvh(&clip);
    group.throughput(Throughput::Bytes(text.len() as u64));
    let options = ReadOptions::default();
    group.bench_function("read/frames/10000", |b| {
        b.iter(|| read(Capture::Bvh(text.as_bytes()), "walk", &options).expect("our own file"));
    });
    group.bench_function("write/frames/10000", |b| b.iter(|| to_bvh(&clip)));
    group.finish();
}

fn sampling(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("resample");
    group.sample_size(10);
    for frames in [200, 1_000] {
        let mut editor = Editor::new(chain(4, frames)).expect("a regular scene");
        editor.solve().expect("an answer");
        group.throughput(Throughput::Elements(4 * frames as u64));
        group.bench_function(BenchmarkId::new("frames", frames), |b| {
            b.iter(|| resample(editor.scene(), editor.edit()).expect("a short result"));
        });
    }
    group.finish();
}

criterion_group!(benches, assemble_and_factor, drag_update, clips, sampling);
criterion_main!(benches);
