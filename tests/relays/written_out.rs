//! A scene with its groups written out as text, by nothing but replacing words.

/// A group of a scene file: columns, rows of cells as text, and the text of its tables.
struct Group {
    keys: Vec<String>,
    rows: Vec<Vec<String>>,
    tables: String,
}

/// The same scene without groups: what is outside them, then every row of each. For scenes in which every group ends where a
/// comment at the start of a line, or a table that is not the group's, begins.
pub(crate) fn written_out(scene: &str) -> String {
    let (mut rest, mut groups) = (String::new(), Vec::new());
    let mut lines = scene.lines().peekable();
    while let Some(line) = lines.next() {
        if line != "[[group]]" {
            rest += &format!("{line}\n");
            continue;
        }
        let keys = lines.next().and_then(|line| line.strip_prefix("keys = ")).expect("columns come first");
        assert_eq!(lines.next(), Some("rows = ["), "rows come next");
        let mut group = Group { keys: cells(keys), rows: Vec::new(), tables: String::new() };
        for line in lines.by_ref().take_while(|line| *line != "]") {
            group.rows.push(cells(line.trim().trim_end_matches(',')));
        }
        let foreign =
            |line: &str| line.starts_with('#') || line.starts_with('[') && !line.starts_with("[[group.");
        while let Some(line) = lines.next_if(|line| !foreign(line)) {
            group.tables += &format!("{line}\n");
        }
        groups.push(group);
    }
    groups.iter().for_each(|group| group.rows.iter().for_each(|row| rest += &filled(group, row)));
    rest
}

/// Cells of an array in brackets, brackets within them left alone.
fn cells(array: &str) -> Vec<String> {
    let inside = array.strip_prefix('[').and_then(|array| array.strip_suffix(']')).expect("an array");
    let (mut cells, mut depth) = (vec![String::new()], 0);
    for c in inside.chars() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ => {}
        }
        if c == ',' && depth == 0 {
            cells.push(String::new());
        } else {
            cells.last_mut().expect("there is one").push(c);
        }
    }
    cells.into_iter().map(|cell| cell.trim().to_owned()).collect()
}

fn filled(group: &Group, row: &[String]) -> String {
    let mut text = group.tables.replace("[[group.", "[[").replace("[group.", "[");
    for (key, cell) in group.keys.iter().zip(row) {
        let key = key.trim_matches('"');
        text = text.replace(&format!("\"{{{key}}}\""), cell);
        text = text.replace(&format!("{{{key}}}"), cell.trim_matches('"'));
        if let Ok(number) = cell.parse::<i64>() {
            text = text.replace(&format!("{{{key}+1}}"), &(number + 1).to_string());
        }
    }
    assert!(!text.contains("{n") && !text.contains("\"{"), "every placeholder is filled in: {text}");
    text
}
