//! `cotillion convert`: a clip in, a BVH file out.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::inspect::inspect;
use cotillion::export::bvh::to_bvh_with;

use super::bvh_args::BvhArgs;
use super::capture::plain;
use super::output::Output;
use super::{ConvertArgs, Failure};

pub(crate) fn convert(args: &ConvertArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    if std::fs::canonicalize(&args.clip)
        .is_ok_and(|clip| std::fs::canonicalize(&args.output).is_ok_and(|own| own == clip))
    {
        let message = "this is the file that is converted".to_owned();
        let help = Some("name another file to write; captures are never overwritten".to_owned());
        return Err(output.fail(plain(&args.output.display().to_string(), message, help)));
    }
    let read = args.read.options().and_then(|options| args.read.read(&args.clip, &options));
    let read = read.map_err(|error| output.fail(error))?;
    write_bvh(&output, &args.output, &read.clip, &args.bvh)?;
    for note in &read.notes {
        output.say(&format!("  {note}\n"));
    }
    output.print_json(&inspect(&args.clip.display().to_string(), &read));
    Ok(())
}

/// Writes `clip` as BVH and says so.
pub(super) fn write_bvh(output: &Output, path: &Path, clip: &Clip, args: &BvhArgs) -> Result<(), Failure> {
    if !path.extension().is_some_and(|own| own.eq_ignore_ascii_case("bvh")) {
        let message = "BVH is what is written, and this is the name of something else".to_owned();
        let help = Some("end the name in .bvh".to_owned());
        return Err(output.fail(plain(&path.display().to_string(), message, help)));
    }
    let options = args.options().map_err(|error| output.fail(error))?;
    output.write_file(path, to_bvh_with(clip, &options).as_bytes())?;
    let seconds = (clip.frame_count() - 1) as f64 / clip.fps;
    let rate = options.fps.unwrap_or(clip.fps);
    output.say(&format!("{}: {seconds:.2} s at {rate} frames per second\n", path.display()));
    Ok(())
}
