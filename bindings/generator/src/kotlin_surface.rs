//! The public declarations of generated Kotlin, one a line, for people to review.

/// The declarations in `source` that apps may call: each with the names of the types that it stands in.
///
/// UniFFI prints one declaration a line but for parameters, which may take several; its own machinery is left out by
/// name.
pub fn declarations(source: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut enclosing: Vec<Enclosing> = Vec::new();
    // A type whose brace may stand on a line to come.
    let mut pending: Option<Enclosing> = None;
    let mut depth = 0_usize;
    let mut lines = source.lines();
    let mut is_comment = false;
    while let Some(line) = lines.next() {
        let mut text = line.trim().to_owned();
        if is_comment || text.starts_with("/*") {
            // UniFFI puts the end of a comment and the declaration on one line.
            let Some((_, rest)) = text.split_once("*/") else {
                is_comment = true;
                continue;
            };
            is_comment = false;
            text = rest.trim().to_owned();
        }
        if text.is_empty() || text.starts_with("//") {
            continue;
        }
        let declared = declared(&text);
        // A list of parameters over several lines belongs to its head.
        while declared.is_some() && parentheses(&text) > 0 {
            let Some(next) = lines.next() else { break };
            let next = next.trim();
            if !next.starts_with(['*', '/']) {
                text = format!("{text} {next}");
            }
        }
        while enclosing.last().is_some_and(|outer| depth <= outer.depth) {
            enclosing.pop();
        }
        let is_member = enclosing.last().is_none_or(|outer| depth == outer.depth + 1);
        let is_shown = is_member && enclosing.iter().all(|outer| outer.is_shown);
        let (opens, closes) = (text.matches('{').count(), text.matches('}').count());
        if let Some((kind, name)) = declared {
            let is_public = is_shown && is_public(&text) && !is_machinery(&name);
            let is_companion = kind == "object" && name == COMPANION;
            if is_public && !is_companion {
                found.push(listed(&enclosing, &head(&text)));
            }
            let is_type = matches!(kind, "class" | "interface" | "object");
            let inner = Enclosing { depth, name, is_shown: is_public && is_type };
            pending = None;
            if opens > closes {
                enclosing.push(inner);
            } else if is_type && opens == 0 {
                pending = Some(inner);
            }
        } else if opens > closes && text.starts_with('{') {
            enclosing.extend(pending.take());
        } else if is_shown && !enclosing.is_empty() && is_case(&text) {
            found.push(listed(&enclosing, text.trim_end_matches([',', ';'])));
        }
        depth = (depth + opens).saturating_sub(closes);
    }
    found
}

/// How companion objects, which have no name, are listed.
const COMPANION: &str = "companion";

/// A declaration that others stand in.
struct Enclosing {
    /// The number of open braces about it.
    depth: usize,
    name: String,
    is_shown: bool,
}

fn listed(enclosing: &[Enclosing], declaration: &str) -> String {
    let names = enclosing.iter().map(|outer| outer.name.as_str());
    names.chain([declaration]).collect::<Vec<_>>().join(" / ")
}

/// The keyword and name of what the line declares.
fn declared(text: &str) -> Option<(&'static str, String)> {
    if text.starts_with("companion object") {
        return Some(("object", COMPANION.to_owned()));
    }
    let text = without_annotation(text);
    let mut words = text.split_whitespace().skip_while(|word| is_modifier(word));
    let first = words.next()?;
    let kind = ["class", "interface", "object", "fun", "val", "var", "constructor", "typealias"]
        .into_iter()
        .find(|kind| {
            first == *kind
                || *kind == "constructor" && first.starts_with("constructor(")
                || *kind == "fun" && first.starts_with("fun<")
        })?;
    let rest = words.next().unwrap_or_default();
    let name: String =
        rest.trim_start_matches('`').chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    Some((kind, name))
}

fn is_modifier(word: &str) -> bool {
    let modifiers = [
        "public",
        "private",
        "internal",
        "protected",
        "open",
        "override",
        "sealed",
        "data",
        "enum",
        "abstract",
        "companion",
        "inline",
        "const",
        "lateinit",
        "external",
        "operator",
    ];
    modifiers.contains(&word)
}

/// The text without `@Throws(…)` at its beginning.
fn without_annotation(text: &str) -> &str {
    match text.strip_prefix('@').and_then(|text| text.split_once(')')) {
        Some((_, rest)) => rest.trim_start(),
        None => text,
    }
}

fn is_public(text: &str) -> bool {
    let mut modifiers = without_annotation(text).split_whitespace().take_while(|word| is_modifier(word));
    !modifiers.any(|word| ["private", "internal", "protected"].contains(&word))
}

/// What UniFFI needs for itself and cannot hide.
fn is_machinery(name: &str) -> bool {
    let prefixes =
        ["Uniffi", "uniffi", "FfiConverter", "RustBuffer", "ForeignBytes", "ErrorHandler", "NoHandle"];
    prefixes.iter().any(|prefix| name.starts_with(prefix))
        || ["", "Disposable", "InternalException", "destroy", "lift", "message"].contains(&name)
        || name.ends_with("Interface")
}

/// A case of an enumeration.
fn is_case(text: &str) -> bool {
    let name = text.trim_end_matches([',', ';']);
    !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c == '_')
}

/// The declaration without its body.
fn head(text: &str) -> String {
    let text = without_annotation(text);
    let mut depth = 0;
    let end = text.char_indices().find(|&(at, c)| {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        depth == 0 && (c == '{' || text[at..].starts_with("= "))
    });
    let head = &text[..end.map_or(text.len(), |(at, _)| at)];
    let words: Vec<&str> =
        head.split_whitespace().filter(|word| !["override", "public"].contains(word)).collect();
    let mut head = words.join(" ").replace('`', "").replace("kotlin.", "");
    for (printed, plain) in [("( ", "("), (" ,", ","), (", )", ")"), (" )", ")"), (" (", "(")] {
        head = head.replace(printed, plain);
    }
    head.trim_end_matches([':', '=', ' ']).to_owned()
}

fn parentheses(text: &str) -> isize {
    text.matches('(').count() as isize - text.matches(')').count() as isize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apps_see_public_declarations_and_no_machinery() {
        let source = "\
/** A fix. */
data class Fix (
    /** When. */
    val `timeNs`: kotlin.Long,
    val `mode`: FixMode
){
    companion object
}
internal object FfiConverterTypeFix {
    fun read(): Fix { return Fix() }
}
open class Positioner: Disposable {
    private val handle = 1
    @Throws(ApiException::class)override fun `hint`(`hint`: PositionHint) {
        val local = 1
    }
    /**
     * The fix.
     */override fun `fix`(): Fix? {
        return null
    }
    override fun destroy() {}
}
open class BuildingMap: Disposable
{
    companion object {
        @Throws(ApiException::class) fun `open`(`path`: kotlin.String): BuildingMap {
            return BuildingMap()
        }
    }
}
enum class FixMode {
    STARTED,
    STALE;
}
";
        assert_eq!(
            declarations(source),
            [
                "data class Fix(val timeNs: Long, val mode: FixMode)",
                "open class Positioner: Disposable",
                "Positioner / fun hint(hint: PositionHint)",
                "Positioner / fun fix(): Fix?",
                "open class BuildingMap: Disposable",
                "BuildingMap / companion / fun open(path: String): BuildingMap",
                "enum class FixMode",
                "FixMode / STARTED",
                "FixMode / STALE"
            ]
        );
    }
}
