//! What somebody may have meant: names that look alike.

/// At most this many names are listed.
const LONGEST_LIST: usize = 20;

/// The most similar of `known`, where it is similar enough to be a slip.
pub fn closest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    similar(name, known, 0.6).into_iter().next()
}

/// Those of `known` that are at least so like `name` (1: the same, but for case), the most similar first.
pub fn similar<'a>(name: &str, known: impl IntoIterator<Item = &'a str>, least: f64) -> Vec<&'a str> {
    let lower = name.to_lowercase();
    let mut similar: Vec<_> = known
        .into_iter()
        .map(|candidate| {
            let likeness = strsim::normalized_damerau_levenshtein(&lower, &candidate.to_lowercase());
            (likeness, candidate)
        })
        .filter(|(likeness, _)| *likeness >= least)
        .collect();
    similar.sort_by(|a, b| b.0.total_cmp(&a.0));
    similar.into_iter().map(|(_, candidate)| candidate).collect()
}

/// `did you mean "walk"? known: "walk", "run"`, as far as there is something to say.
pub fn remedy(name: &str, what: &str, known: &[&str]) -> String {
    if known.is_empty() {
        return format!("there are no {what} here");
    }
    let list = list(known);
    match closest(name, known.iter().copied()) {
        Some(meant) => format!("did you mean \"{meant}\"? {what}: {list}"),
        None => format!("{what}: {list}"),
    }
}

/// `"a", "b"`, cut short where it is long.
pub fn list(names: &[&str]) -> String {
    let mut list =
        names.iter().take(LONGEST_LIST).map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    if names.len() > LONGEST_LIST {
        list += &format!(" and {} more", names.len() - LONGEST_LIST);
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_name_and_a_stranger_none() {
        assert_eq!(closest("wlak", ["idle", "walk", "run"]), Some("walk"));
        assert_eq!(closest("Walk", ["idle", "walk"]), Some("walk"));
        assert_eq!(closest("zebra", ["idle", "walk"]), None);
    }
}
