//! Acclaim motions put joints where products of 4 × 4 matrices put them, evaluated apart from the program.
//!
//! Looks for captures in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists the test on
//! them is ignored, by name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use cotillion::clip::read::{Capture, ReadOptions, read};
use cotillion::index::SourceFrame;
use libtest_mimic::{Arguments, Failed, Trial};

/// Rounding of matrices and quaternions through ten joints of a body that is metres from the origin.
const ROUNDING: f64 = 1e-12;

/// Bones whose axes are skew and written in all orders, and whose angles come in any.
const SKELETON: &str = ":units
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin id 1 name a direction 0.6 0.8 0 length 3 axis 10 20 30 XYZ
    dof rx ry rz
  end
  begin id 2 name b direction 0 0.6 -0.8 length 2 axis -40 50 60 ZYX
    dof rz rx
  end
  begin id 3 name c direction 1 0 0 length 1 axis 70 -80 90 YZX
    dof ry
  end
  begin id 4 name d direction 0 0 1 length 4 axis 0 0 0 XYZ
  end
  begin id 5 name e direction 0 0 1 length 4 axis 5 6 7 ZXY
    dof rz ry rx
  end
:hierarchy
  begin
    root a d
    a b
    b c
    d e
  end
";

const MOTION: &str = ":FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
a 15 -25 35
b -45 55
c 65
e 1 2 3
2
root -1 4 2 100 -70 200
a 5 80 -35
b 145 -155
c -65
e -90 170 45
";

fn main() {
    let arguments = Arguments::from_args();
    let by_hand = Trial::test("skew axes in all orders", || compare(SKELETON, MOTION));
    let folder = mocap_folder();
    let is_missing = folder.is_none();
    let capture = Trial::test("cmu_16_15_walk_straight", move || {
        let folder = folder.ok_or("no captures found")?;
        let text = |name: &str| std::fs::read_to_string(folder.join("amc").join(name));
        compare(&text("cmu_16.asf")?, &text("cmu_16_15_walk_straight.amc")?)
    });
    libtest_mimic::run(&arguments, vec![by_hand, capture.with_ignored_flag(is_missing)]).exit();
}

fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}

/// Every joint of every frame is where the matrices put the start of its bone.
fn compare(skeleton: &str, motion: &str) -> Result<(), Failed> {
    let capture = Capture::Acclaim { skeleton: skeleton.as_bytes(), motion: motion.as_bytes() };
    let read = read(capture, "compared", &ReadOptions::default())?;
    let bones = bones(skeleton);
    let frames = frames(motion);
    if frames.len() != read.clip.frame_count() || bones.len() + 1 != read.clip.skeleton.joints.len() {
        return Err("another number of frames or joints".into());
    }
    for (k, frame) in frames.iter().enumerate() {
        let expected = starts(&bones, frame);
        let found = read.clip.skeleton.forward_kinematics(&read.clip.pose(SourceFrame::from_usize(k)));
        for (joint, found) in read.clip.skeleton.joints.iter().zip(found) {
            let expected = expected[&joint.name].map(|coordinate| coordinate * 0.0254 / 0.45);
            let off = found.position.distance(expected.into());
            if off.is_nan() || off > ROUNDING {
                return Err(format!("{} in frame {k} is {off:e} m off", joint.name).into());
            }
        }
    }
    Ok(())
}

struct Bone {
    name: String,
    parent: String,
    end: [f64; 3],
    /// To the body's axes.
    axes: Matrix,
    /// `rx` and the like.
    dofs: Vec<String>,
}

/// Bones of the skeleton, parents first.
fn bones(text: &str) -> Vec<Bone> {
    let (data, tree) = text.split_once(":hierarchy").expect("a hierarchy");
    let data = data.split_once(":bonedata").expect("bones").1;
    let found: Vec<Vec<&str>> =
        data.split("begin").skip(1).map(|bone| bone.split_whitespace().collect()).collect();
    let parsed: HashMap<&str, &Vec<&str>> =
        found.iter().map(|words| (after(words, "name")[0], words)).collect();
    let mut bones = Vec::new();
    for line in tree.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some((parent, children)) = words.split_first() else { continue };
        for child in children {
            bones.push(bone(child, parent, parsed[child]));
        }
    }
    bones
}

fn bone(name: &str, parent: &str, words: &[&str]) -> Bone {
    let number = |word: &&str| word.parse::<f64>().expect("a number");
    let length = number(&after(words, "length")[0]);
    let end = [0, 1, 2].map(|k| length * number(&after(words, "direction")[k]));
    let axis = after(words, "axis");
    let mut axes = IDENTITY;
    for letter in axis[3].to_lowercase().chars() {
        let place = "xyz".find(letter).expect("an axis");
        axes = product(about(letter, number(&axis[place])), axes);
    }
    let dofs = match words.iter().position(|word| *word == "dof") {
        None => Vec::new(),
        Some(at) => words[at + 1..]
            .iter()
            .take_while(|word| word.starts_with('r'))
            .map(|word| (*word).to_owned())
            .collect(),
    };
    Bone { name: name.to_owned(), parent: parent.to_owned(), end, axes, dofs }
}

fn after<'a, 'w>(words: &'w [&'a str], key: &str) -> &'w [&'a str] {
    let at = words.iter().position(|word| *word == key).expect("the field is there");
    &words[at + 1..]
}

/// Values of each frame by the bones' names.
fn frames(text: &str) -> Vec<HashMap<&str, Vec<f64>>> {
    let mut frames: Vec<HashMap<&str, Vec<f64>>> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with(['#', ':'])) {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [] => {}
            [_] => frames.push(HashMap::new()),
            [name, ref values @ ..] => {
                let values = values.iter().map(|value| value.parse().expect("a number")).collect();
                frames.last_mut().expect("a frame's number comes first").insert(name, values);
            }
        }
    }
    frames
}

/// Where each bone starts, file units: the root's matrix, then for each bone that of its parent, moved to the parent's end,
/// times `C M C⁻¹`.
fn starts(bones: &[Bone], frame: &HashMap<&str, Vec<f64>>) -> HashMap<String, [f64; 3]> {
    let root = &frame["root"];
    let turned = turn(&["rx", "ry", "rz"], &root[3..]);
    let mut matrices =
        HashMap::from([("root", (product(moved([root[0], root[1], root[2]]), turned), [0.0; 3]))]);
    for bone in bones {
        let (above, end) = matrices[bone.parent.as_str()];
        let dofs: Vec<&str> = bone.dofs.iter().map(String::as_str).collect();
        let values = frame.get(bone.name.as_str()).map_or(&[][..], |values| values);
        let own = product(product(bone.axes, turn(&dofs, values)), transposed(bone.axes));
        matrices.insert(&bone.name, (product(above, product(moved(end), own)), bone.end));
    }
    let place = |(matrix, _): (Matrix, _)| [matrix[0][3], matrix[1][3], matrix[2][3]];
    matrices.into_iter().map(|(name, entry)| (name.to_owned(), place(entry))).collect()
}

/// Rows of a 4 × 4 matrix on columns (x, y, z, 1).
type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn product(a: Matrix, b: Matrix) -> Matrix {
    let entry = |row: usize, column: usize| (0..4).map(|k| a[row][k] * b[k][column]).sum();
    [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| entry(row, column)))
}

/// Inverse of a rotation.
fn transposed(a: Matrix) -> Matrix {
    [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column: usize| a[column][row]))
}

fn moved([x, y, z]: [f64; 3]) -> Matrix {
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]
}

fn turn(dofs: &[&str], degrees: &[f64]) -> Matrix {
    let turns = dofs.iter().zip(degrees).map(|(dof, degrees)| about(dof.as_bytes()[1].into(), *degrees));
    turns.fold(IDENTITY, |matrix, turn| product(turn, matrix))
}

fn about(axis: char, degrees: f64) -> Matrix {
    let (s, c) = degrees.to_radians().sin_cos();
    match axis {
        'x' => [[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [0.0, 0.0, 0.0, 1.0]],
        'y' => [[c, 0.0, s, 0.0], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, 0.0], [0.0, 0.0, 0.0, 1.0]],
        _ => [[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    }
}
