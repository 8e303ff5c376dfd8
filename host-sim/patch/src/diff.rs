//! A readable diff of a patched file.

use super::patch::Patch;

/// Returns the changed lines, each after the reasons for its change, and the command that undoes all. Line numbers are those of
/// the file before.
pub fn diff(before: (&str, &str), after: (&str, &str), patches: &[&Patch]) -> String {
    let ((old_name, old), (new_name, new)) = (before, after);
    let mut text = format!("--- {old_name}\n+++ {new_name}\n");
    for patch in patches {
        let interval = patch.ci95.map(|[low, high]| format!(", 95 % {low} to {high}")).unwrap_or_default();
        let unit = if patch.unit.is_empty() { String::new() } else { format!(" {}", patch.unit) };
        text += &format!("# {}: {} ({}{unit}{interval})\n", patch.effect, patch.reason, patch.tag);
    }
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    let mut at = [0, 0];
    while at[0] < old.len() || at[1] < new.len() {
        if old.get(at[0]) == new.get(at[1]) {
            at = [at[0] + 1, at[1] + 1];
            continue;
        }
        // Lines are replaced one by one; a line is added only before one that stays.
        let is_added = new.get(at[1] + 1).is_some() && new.get(at[1] + 1) == old.get(at[0]);
        text += &format!("@@ line {} @@\n", at[0] + 1);
        if !is_added {
            text += &old.get(at[0]).map(|line| format!("-{line}\n")).unwrap_or_default();
            at[0] += 1;
        }
        text += &new.get(at[1]).map(|line| format!("+{line}\n")).unwrap_or_default();
        at[1] += 1;
    }
    text + &format!("# undo: cp {old_name} {new_name}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaced_and_added_lines_are_shown_with_their_numbers() {
        let text = diff(("a.yaml", "a: 1\nb: 2\nc: 3\n"), ("b.yaml", "a: 1\nx: 0\nb: 2\nc: 4\n"), &[]);
        let expected =
            "--- a.yaml\n+++ b.yaml\n@@ line 2 @@\n+x: 0\n@@ line 3 @@\n-c: 3\n+c: 4\n# undo: cp a.yaml b.yaml\n";
        assert_eq!(text, expected);
    }
}
