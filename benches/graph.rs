//! What a motion graph costs by frames of one body. `COTILLION_BENCH_LARGE=1` adds 100 000 frames, an hour of motion.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use cotillion::clip::builtin::generate;
use cotillion::clip::working::WorkingClip;
use cotillion::graph::{GraphSettings, material, motion_graph, search};
use criterion::{BenchmarkId, Criterion, Throughput};

/// Frames of all clips together.
const SIZES: [usize; 3] = [1_000, 4_000, 16_000];

/// Walks of one body, all different in speed and turn, every fifth clip somebody who stands; `frames` in all.
fn clips(frames: usize) -> Vec<Arc<WorkingClip>> {
    let mut clips: Vec<Arc<WorkingClip>> = Vec::new();
    let mut count = 0;
    while count < frames {
        let k = clips.len();
        let golden = (k as f64 * 0.618_033_988_749_895).fract();
        let (name, parameters) = match k % 5 {
            4 => ("idle", vec![("seconds", 5.0 + 5.0 * golden)]),
            _ => (
                "walk",
                vec![("speed", 0.8 + 0.9 * golden), ("turn", 60.0 * golden - 30.0), ("seconds", 20.0)],
            ),
        };
        let parameters: BTreeMap<String, f64> =
            parameters.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        let clip = Arc::new(generate(name, &parameters).expect("the parameters are within their ranges"));
        let (first, last) = clip.usable;
        let working = Arc::new(WorkingClip::new(&clip.name, clip.clone(), first, last));
        count += working.frame_count();
        clips.push(working);
    }
    clips
}

fn graph_by_frames(criterion: &mut Criterion) {
    let mut sizes = SIZES.to_vec();
    sizes.extend(std::env::var_os("COTILLION_BENCH_LARGE").map(|_| 100_000));
    let mut group = criterion.benchmark_group("motion_graph/frames");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for size in sizes {
        let clips = clips(size);
        let pairs = size as u64 * size as u64 / 2;
        group.throughput(Throughput::Elements(pairs));
        group.bench_with_input(BenchmarkId::from_parameter(size), &clips, |bencher, clips| {
            bencher.iter(|| black_box(motion_graph(clips, &GraphSettings::default())));
        });
    }
    group.finish();
    let clips = clips(SIZES[1]);
    let ready = material(&clips);
    let mut group = criterion.benchmark_group("motion_graph/parts");
    group.bench_function("material/4000", |bencher| bencher.iter(|| black_box(material(&clips))));
    group.bench_function("search/4000", |bencher| {
        bencher.iter(|| black_box(search(&ready, &GraphSettings::default())));
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    graph_by_frames(&mut criterion);
    criterion.final_summary();
}
