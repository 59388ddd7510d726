//! Combinations of the values that `--each` gives to keys of a case.

use crate::status::CommandFailure;

/// One combination.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Variant {
    /// Name of its folder; empty if there is nothing to combine.
    pub folder: String,
    /// Keys with their values, as TOML.
    pub values: Vec<(String, String)>,
}

impl Variant {
    /// The values as overrides of a case.
    pub fn overrides(&self) -> Vec<String> {
        self.values.iter().map(|(key, value)| format!("{key}={value}")).collect()
    }
}

/// All combinations of the values of arguments `KEY=VALUE,VALUE,…`; the last key varies fastest.
pub fn variants(each: &[String]) -> Result<Vec<Variant>, CommandFailure> {
    let mut variants = vec![Variant::default()];
    for argument in each {
        let parts = argument.split_once('=').map(|(key, values)| (key.trim(), split(values)));
        let Some((key, values)) = parts.filter(|(key, values)| !key.is_empty() && values.iter().all(|v| !v.is_empty()))
        else {
            return Err(CommandFailure::Usage(format!("--each {argument}: expected KEY=VALUE,VALUE,…")));
        };
        if variants.iter().any(|variant| variant.values.iter().any(|(known, _)| known == key)) {
            return Err(CommandFailure::Usage(format!("--each {argument}: found {key} twice, expected each key once")));
        }
        let short = key.rsplit('.').next().unwrap_or(key);
        variants = variants
            .iter()
            .flat_map(|variant| {
                values.iter().map(move |value| {
                    let part = format!("{short}={}", plain(value));
                    let folder = if variant.folder.is_empty() { part } else { format!("{},{part}", variant.folder) };
                    let values = variant.values.iter().cloned().chain([(key.to_owned(), value.clone())]).collect();
                    Variant { folder, values }
                })
            })
            .collect();
    }
    // Two values that give the same name, such as "a/b" and "a-b", get numbers.
    for i in 1..variants.len() {
        let same = variants[..i].iter().filter(|other| other.folder == variants[i].folder).count();
        if same > 0 {
            variants[i].folder = format!("{}-{}", variants[i].folder, same + 1);
        }
    }
    Ok(variants)
}

/// The values between commas outside of quotes and brackets.
fn split(values: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quote) = (vec![String::new()], 0usize, None);
    for c in values.chars() {
        match (quote, c) {
            (Some(open), _) => quote = (c != open).then_some(open),
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth = depth.saturating_sub(1),
            (None, ',') if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(part) = parts.last_mut() {
            part.push(c);
        }
    }
    parts.iter().map(|part| part.trim().to_owned()).collect()
}

/// A value as part of a folder name that is valid on every system.
fn plain(value: &str) -> String {
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, '.' | '-' | '+' | '_');
    let text: String = value.trim_matches(['"', '\'']).chars().map(|c| if allowed(c) { c } else { '-' }).collect();
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_with_commas_of_their_own_stay_whole() {
        let each = ["load.body_force=[0, -1],[0, -2]", "contact.gap=\"max(x, 0)\",0.1"].map(str::to_owned);
        let made = variants(&each).expect("variants");
        let folders: Vec<&str> = made.iter().map(|variant| variant.folder.as_str()).collect();
        assert_eq!(
            folders,
            [
                "body_force=-0---1-,gap=max-x--0-",
                "body_force=-0---1-,gap=0.1",
                "body_force=-0---2-,gap=max-x--0-",
                "body_force=-0---2-,gap=0.1"
            ]
        );
        assert_eq!(made[3].overrides(), ["load.body_force=[0, -2]", "contact.gap=0.1"]);
    }

    #[test]
    fn names_differ_where_values_do() {
        let made = variants(&["name=\"a/b\",\"a:b\"".to_owned()]).expect("variants");
        assert_eq!([made[0].folder.as_str(), made[1].folder.as_str()], ["name=a-b", "name=a-b-2"]);
    }

    #[test]
    fn what_has_no_values_is_refused() {
        for wrong in ["mesh.n", "=1", "mesh.n=", "mesh.n=1,,2"] {
            assert!(variants(&[wrong.to_owned()]).is_err(), "{wrong}");
        }
        assert!(variants(&["mesh.n=1".to_owned(), "mesh.n=2".to_owned()]).is_err());
    }
}
