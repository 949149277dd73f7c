//! The public declarations of Swift sources, one a line, for people to review.

/// The declarations in `source` that apps may call: each with the names of the types that it stands in.
///
/// What UniFFI needs for itself and cannot hide is left out by name.
pub fn declarations(source: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut enclosing: Vec<Enclosing> = Vec::new();
    for statement in statements(&without_comments(source)) {
        let scope = match statement {
            Statement::End => {
                enclosing.pop();
                continue;
            }
            Statement::Line(text) | Statement::Opening(text) => scope_of(text, &enclosing),
        };
        if let Some(listed) = &scope.listed {
            let names = enclosing.iter().map(|outer| outer.name.as_str());
            found.push(names.chain([listed.as_str()]).collect::<Vec<_>>().join(" / "));
        }
        if matches!(statement, Statement::Opening(_)) {
            enclosing.push(scope);
        }
    }
    found
}

/// A declaration that others may stand in.
struct Enclosing {
    name: String,
    kind: &'static str,
    /// Whether its members are shown.
    is_shown: bool,
    listed: Option<String>,
}

enum Statement<'a> {
    /// To the end of its line.
    Line(&'a str),
    /// To a brace that opens.
    Opening(&'a str),
    /// A brace that closes.
    End,
}

const TYPES: [&str; 5] = ["class", "struct", "enum", "protocol", "actor"];
const MEMBERS: [&str; 7] = ["func", "init", "var", "let", "case", "typealias", "subscript"];

fn scope_of(text: &str, enclosing: &[Enclosing]) -> Enclosing {
    let hidden = || Enclosing { name: String::new(), kind: "", is_shown: false, listed: None };
    if !enclosing.iter().all(|outer| outer.is_shown) {
        return hidden();
    }
    let mut words = without_attributes(text).split_whitespace().peekable();
    let mut modifiers = Vec::new();
    while let Some(word) = words.next_if(|word| is_modifier(word)) {
        modifiers.push(word);
    }
    // `class func` is a member, `final class` a type.
    let Some(first) = words.next() else { return hidden() };
    let Some(&kind) = TYPES.iter().chain(&MEMBERS).chain(&["extension"]).find(|kind| {
        first == **kind || first.strip_prefix(**kind).is_some_and(|rest| rest.starts_with(['(', '?']))
    }) else {
        return hidden();
    };
    let rest = words.next().unwrap_or_default();
    let rest = if kind == "init" || kind == "subscript" { "" } else { rest };
    let name: String = rest
        .trim_start_matches('`')
        .chars()
        .take_while(|c| c.is_alphanumeric() || "_.".contains(*c))
        .collect();
    if kind == "extension" {
        return Enclosing { is_shown: !is_machinery(&name), name, kind, listed: None };
    }
    let outer_kind = enclosing.last().map_or("", |outer| outer.kind);
    let is_public = modifiers.iter().any(|word| ["public", "open"].contains(word))
        || outer_kind == "protocol"
        || kind == "case" && outer_kind == "enum";
    if !is_public
        || is_machinery(&name)
        || text.contains("init(unsafeFromHandle")
        || text.contains("init(noHandle")
    {
        return hidden();
    }
    Enclosing { name, kind, is_shown: TYPES.contains(&kind), listed: Some(head(text)) }
}

fn is_modifier(word: &str) -> bool {
    let modifiers = [
        "public",
        "open",
        "internal",
        "private",
        "fileprivate",
        "private(set)",
        "final",
        "static",
        "override",
        "convenience",
        "required",
        "mutating",
        "nonisolated",
        "indirect",
        "lazy",
        "weak",
    ];
    modifiers.contains(&word)
}

/// The text without `@objc`, `@available(…)` at its beginning.
fn without_attributes(text: &str) -> &str {
    let mut text = text.trim_start();
    while let Some(attribute) = text.strip_prefix('@') {
        let name = attribute.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(attribute.len());
        let rest = &attribute[name..];
        text = match rest.strip_prefix('(').and_then(|rest| rest.split_once(')')) {
            Some((_, rest)) => rest.trim_start(),
            None => rest.trim_start(),
        };
    }
    text
}

/// What UniFFI needs for itself and cannot hide.
fn is_machinery(name: &str) -> bool {
    let prefixes = ["Uniffi", "uniffi", "FfiConverter", "RustBuffer", "ForeignBytes"];
    prefixes.iter().any(|prefix| name.starts_with(prefix))
        || ["NoHandle", "errorDescription"].contains(&name)
        || name.ends_with("Protocol")
}

/// The declaration without its value.
fn head(text: &str) -> String {
    let text = without_attributes(text);
    let mut depth = 0;
    let end = text.char_indices().find(|&(at, c)| {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            _ => {}
        }
        depth == 0 && text[at..].starts_with(" = ")
    });
    let words = text[..end.map_or(text.len(), |(at, _)| at)].split_whitespace();
    let head =
        words.filter(|word| !["public", "open", "convenience"].contains(word)).collect::<Vec<_>>().join(" ");
    head.replace('`', "")
        .replace("( ", "(")
        .replace(" )", ")")
        .replace(" ,", ",")
        .replace(")throws", ") throws")
}

/// The source cut at line ends and braces outside parentheses.
fn statements(source: &str) -> Vec<Statement<'_>> {
    let mut statements = Vec::new();
    let (mut start, mut depth) = (0, 0_usize);
    let mut is_text = false;
    let mut previous = ' ';
    for (at, c) in source.char_indices() {
        match c {
            '"' if previous != '\\' => is_text = !is_text,
            _ if is_text => {}
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            '\n' | '{' | '}' if depth == 0 => {
                let text = source[start..at].trim();
                // UniFFI puts a type's `public` on a line of its own.
                if c == '\n' && !text.is_empty() && text.split_whitespace().all(is_modifier) {
                    previous = c;
                    continue;
                }
                start = at + 1;
                if c == '{' {
                    statements.push(Statement::Opening(text));
                } else if !text.is_empty() && !text.starts_with('#') {
                    statements.push(Statement::Line(text));
                }
                if c == '}' {
                    statements.push(Statement::End);
                }
            }
            _ => {}
        }
        previous = c;
    }
    statements
}

/// The source without `//` and `/* */`.
fn without_comments(source: &str) -> String {
    let mut text = String::with_capacity(source.len());
    let mut is_block = false;
    for line in source.lines() {
        let mut rest = line;
        loop {
            if is_block {
                let Some((_, after)) = rest.split_once("*/") else { break };
                (rest, is_block) = (after, false);
            }
            let begin = [rest.find("//"), rest.find("/*")].into_iter().flatten().min();
            // A `//` behind a quotation mark may be part of a text, as in an address.
            match begin.filter(|&at| rest[..at].matches('"').count() % 2 == 0) {
                Some(at) if rest[at..].starts_with("/*") => {
                    text += &rest[..at];
                    (rest, is_block) = (&rest[at + 2..], true);
                }
                Some(at) => {
                    text += &rest[..at];
                    break;
                }
                None => {
                    text += rest;
                    break;
                }
            }
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apps_see_public_declarations_and_no_machinery() {
        let source = r#"
/**
 * A fix.
 */
public struct Fix: Equatable, Hashable {
    /// When { or where.
    public var timeNs: Int64
    public private(set) var count: Int = 0
    public init(
        /**
         * When.
         */timeNs: Int64 = 5, name: String = "a { b")  {
        self.timeNs = timeNs
    }
    var hidden: Int { 3 }
}
#if compiler(>=6)
extension Fix: Sendable {}
#endif
@_documentation(visibility: private)
public struct FfiConverterTypeFix: FfiConverterRustBuffer {
    public static func read(from buf: inout (data: Data, offset: Data.Index)) throws -> Fix {
        return try Fix(timeNs: .read(from: &buf))
    }
}
public protocol PositionerProtocol: AnyObject, Sendable {
    func fix() throws  -> Fix?
}
open class Positioner: PositionerProtocol, @unchecked Sendable {
    fileprivate let handle: UInt64
    public struct NoHandle {
        public init() {}
    }
    required public init(unsafeFromHandle handle: UInt64) {
        self.handle = handle
    }
public convenience init(map: BuildingMap, floor: Int32)throws  {
    let handle =
        try rustCallWithError(FfiConverterTypeApiError_lift) {
    uniffi_new(
        FfiConverterTypeBuildingMap_lower(map),$0
    )
}
    self.init(unsafeFromHandle: handle)
}
    deinit {
    }
open func fix()throws  -> Fix?  {
    return try  FfiConverterOptionTypeFix.lift(try rustCallWithError(FfiConverterTypeApiError_lift) {
    uniffi_fix(self.uniffiCloneHandle(), $0)
})
}
}
public 
enum FixMode: Equatable {
    case started
    case other(code: Int)
    public var isSure: Bool {
        switch self {
        case .started: return true
        default: return false
        }
    }
}
public protocol SensorSource: Sendable {
    func start(_ sink: SampleSink) throws
}
extension Fix {
    @available(iOS 15, *)
    public func distance(to other: Fix) -> Double { 0 }
    func secret() {}
    public init?(bytes: Data, at: Int) {}
}
func internalOnly() {}
public func version() -> String  {
    return "\(1)"
}
"#;
        assert_eq!(
            declarations(source),
            [
                "struct Fix: Equatable, Hashable",
                "Fix / var timeNs: Int64",
                "Fix / private(set) var count: Int",
                "Fix / init(timeNs: Int64 = 5, name: String = \"a { b\")",
                "class Positioner: PositionerProtocol, @unchecked Sendable",
                "Positioner / init(map: BuildingMap, floor: Int32) throws",
                "Positioner / func fix() throws -> Fix?",
                "enum FixMode: Equatable",
                "FixMode / case started",
                "FixMode / case other(code: Int)",
                "FixMode / var isSure: Bool",
                "protocol SensorSource: Sendable",
                "SensorSource / func start(_ sink: SampleSink) throws",
                "Fix / func distance(to other: Fix) -> Double",
                "Fix / init?(bytes: Data, at: Int)",
                "func version() -> String"
            ]
        );
    }
}
