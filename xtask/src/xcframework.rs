//! The XCFramework of the engine: built by its script, and its layout checked as Xcode would read it.

use std::fs;
use std::path::Path;

use crate::bindings;
use crate::process::run_into;
use crate::report::Outcome;
use crate::workspace::Workspace;

/// Where the script lays the framework out.
const FRAMEWORK: &str = "ios/FieldwalkFFI.xcframework";
const SCRIPT: &str = "ios/scripts/xcframework.sh";
const HEADER: &str = "ios/Sources/FieldwalkFFI/FieldwalkFFI.h";
/// The script's exit code when there is no Rust for iOS.
const NO_COMPILER: i32 = 3;

/// Mach-O of 64 bits, little-endian.
const MACH_O: [u8; 4] = [0xcf, 0xfa, 0xed, 0xfe];
const CPU_ARM64: u32 = 0x0100_000c;
/// The load command that says for which platform an object was compiled, and its numbers.
const BUILD_VERSION: u32 = 0x32;
const PLATFORM_IOS: u32 = 2;
const PLATFORM_IOS_SIMULATOR: u32 = 7;

/// Generates the header, builds the framework and checks it.
pub fn run(workspace: &Workspace) -> Outcome {
    if let Err(reason) = bindings::generate(workspace, bindings::SWIFT) {
        return Err(reason).into();
    }
    let log = bindings::folder(workspace).join("xcframework.log");
    if let Err(reason) = run_into(&mut workspace.command(workspace.root.join(SCRIPT)), &log) {
        let text = fs::read_to_string(&log).unwrap_or_default();
        return if reason.ends_with(&format!("exit status: {NO_COMPILER}")) {
            Outcome::skipped(text.trim())
        } else {
            eprintln!("{text}");
            Err(reason).into()
        };
    }
    Outcome::found(checked(&workspace.root))
}

/// Checks the framework under `root` where there is one; nothing otherwise.
///
/// # Errors
/// What is wrong with it.
pub fn check_if_there(root: &Path) -> Result<(), String> {
    if root.join(FRAMEWORK).exists() { checked(root).map(drop) } else { Ok(()) }
}

/// Checks the framework under `root` and says what is in it.
fn checked(root: &Path) -> Result<String, String> {
    let header = read(&root.join(HEADER))?;
    let slices = slices_of(&root.join(FRAMEWORK), &header)?;
    let variants: Vec<_> =
        slices.iter().filter(|s| s.platform == "ios").map(|s| s.variant.as_str()).collect();
    for (variant, name) in [("", "devices"), ("simulator", "simulators")] {
        if !variants.contains(&variant) {
            return Err(format!("{FRAMEWORK}: no slice for iOS {name}"));
        }
    }
    let sizes =
        slices.iter().map(|slice| format!("{} {:.1} MB", slice.identifier, slice.n_bytes as f64 / 1e6));
    Ok(format!("{FRAMEWORK}: {}", sizes.collect::<Vec<_>>().join(", ")))
}

/// One library of the framework, with what its list says of it.
#[derive(Debug)]
struct Slice {
    identifier: String,
    platform: String,
    variant: String,
    n_bytes: usize,
}

/// The slices of the framework in `folder`, each of which has `header`.
fn slices_of(folder: &Path, header: &[u8]) -> Result<Vec<Slice>, String> {
    let list = String::from_utf8_lossy(&read(&folder.join("Info.plist"))?).into_owned();
    if string_of(&list, "CFBundlePackageType").as_deref() != Some("XFWK") {
        return Err(format!("{}: Info.plist is no XCFramework's", folder.display()));
    }
    let described = list.split_once("<array>").map_or("", |(_, rest)| rest);
    let mut slices = Vec::new();
    for dict in described.split("<dict>").skip(1) {
        let value = |key: &str| string_of(dict, key).ok_or(format!("Info.plist: a slice without {key}"));
        let slice = folder.join(value("LibraryIdentifier")?);
        let library = read(&slice.join(value("LibraryPath")?))?;
        let headers = slice.join(value("HeadersPath")?).join("FieldwalkFFI");
        if read(&headers.join("FieldwalkFFI.h"))? != header {
            return Err(format!("{}: another header than the generated one", headers.display()));
        }
        let module = String::from_utf8_lossy(&read(&headers.join("module.modulemap"))?).into_owned();
        if !module.contains("module FieldwalkFFI {") || !module.contains("header \"FieldwalkFFI.h\"") {
            return Err(format!("{}: the module map names another module", headers.display()));
        }
        let (platform, variant) = (value("SupportedPlatform")?, string_of(dict, "SupportedPlatformVariant"));
        let variant = variant.unwrap_or_default();
        if !dict.contains("<string>arm64</string>") {
            return Err(format!("{}: without arm64", slice.display()));
        }
        let expected = match (platform.as_str(), variant.as_str()) {
            ("ios", "") => Some(PLATFORM_IOS),
            ("ios", "simulator") => Some(PLATFORM_IOS_SIMULATOR),
            _ => None,
        };
        // Xcode's own slices may hold several architectures in another kind of file.
        if let (Some(expected), true) = (expected, library.starts_with(b"!<arch>\n")) {
            let found = platform_of(&library);
            if found != Some((CPU_ARM64, expected)) {
                return Err(format!("{}: objects of (processor, platform) {found:x?}", slice.display()));
            }
        }
        let identifier = value("LibraryIdentifier")?;
        slices.push(Slice { identifier, platform, variant, n_bytes: library.len() });
    }
    Ok(slices)
}

/// The text of `key` in a property list, the first there is.
fn string_of(list: &str, key: &str) -> Option<String> {
    let (_, rest) = list.split_once(&format!("<key>{key}</key>"))?;
    let (_, rest) = rest.split_once("<string>")?;
    Some(rest.split_once("</string>")?.0.to_owned())
}

/// Processor and platform of the first object in an archive that says its platform.
fn platform_of(archive: &[u8]) -> Option<(u32, u32)> {
    const HEADER_BYTES: usize = 60;
    let mut rest = archive.get(8..)?;
    while let Some((header, after)) = rest.split_at_checked(HEADER_BYTES) {
        let n_bytes: usize = std::str::from_utf8(&header[48..58]).ok()?.trim().parse().ok()?;
        let member = after.get(..n_bytes)?;
        // A long name stands before the content.
        let name = std::str::from_utf8(&header[..16]).unwrap_or_default().trim();
        let n_name = name.strip_prefix("#1/").and_then(|n| n.parse().ok()).unwrap_or(0);
        if let Some(found) = member.get(n_name..).and_then(platform_of_object) {
            return Some(found);
        }
        rest = after.get(n_bytes + n_bytes % 2..).unwrap_or_default();
    }
    None
}

fn platform_of_object(object: &[u8]) -> Option<(u32, u32)> {
    let number = |at: usize| Some(u32::from_le_bytes(object.get(at..at + 4)?.try_into().ok()?));
    if !object.starts_with(&MACH_O) {
        return None;
    }
    let (processor, n_commands) = (number(4)?, number(16)?);
    let mut at = 32;
    for _ in 0..n_commands {
        let (command, n_bytes) = (number(at)?, number(at + 4)?);
        if command == BUILD_VERSION {
            return Some((processor, number(at + 8)?));
        }
        at += usize::try_from(n_bytes).ok().filter(|&n| n >= 8)?;
    }
    None
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// A framework as the script lays it out, with an archive of one object a slice.
    fn framework(name: &str) -> PathBuf {
        let root = std::env::temp_dir().join(format!("fieldwalk-xcframework-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        let mut list = "<key>AvailableLibraries</key><array>".to_owned();
        for (identifier, platform, variant) in [
            ("ios-arm64", PLATFORM_IOS, ""),
            (
                "ios-arm64-simulator",
                PLATFORM_IOS_SIMULATOR,
                "<key>SupportedPlatformVariant</key> <string>simulator</string>",
            ),
        ] {
            let slice = root.join(FRAMEWORK).join(identifier);
            let headers = slice.join("Headers/FieldwalkFFI");
            fs::create_dir_all(&headers).unwrap();
            fs::write(slice.join("lib.a"), archive(platform)).unwrap();
            fs::write(headers.join("FieldwalkFFI.h"), "int a;").unwrap();
            let module = "module FieldwalkFFI {\n    header \"FieldwalkFFI.h\"\n}\n";
            fs::write(headers.join("module.modulemap"), module).unwrap();
            list += &format!(
                "<dict><key>HeadersPath</key><string>Headers</string><key>LibraryIdentifier</key>\
                 <string>{identifier}</string><key>LibraryPath</key><string>lib.a</string>\
                 <key>SupportedArchitectures</key><array><string>arm64</string></array>\
                 <key>SupportedPlatform</key><string>ios</string>{variant}</dict>"
            );
        }
        list += "</array><key>CFBundlePackageType</key><string>XFWK</string>";
        fs::write(root.join(FRAMEWORK).join("Info.plist"), list).unwrap();
        fs::create_dir_all(root.join(HEADER).parent().unwrap()).unwrap();
        fs::write(root.join(HEADER), "int a;").unwrap();
        root
    }

    /// An archive whose first member is no object, with an odd length, and whose second has a long name.
    fn archive(platform: u32) -> Vec<u8> {
        let numbers = [CPU_ARM64, 0, 1, 2, 32, 0, 0, 0x19, 8, BUILD_VERSION, 24, platform, 0, 0, 0];
        let mut object = MACH_O.to_vec();
        object.extend(numbers.iter().flat_map(|n: &u32| n.to_le_bytes()));
        let member = |name: &str, content: &[u8]| {
            let mut bytes = format!("{name:<48}{:<10}`\n", content.len()).into_bytes();
            bytes.extend(content);
            bytes.resize(bytes.len().next_multiple_of(2), b'\n');
            bytes
        };
        [b"!<arch>\n".to_vec(), member("/", b"abc"), member("#1/4", &[b"a.o\0".to_vec(), object].concat())]
            .concat()
    }

    #[test]
    fn a_framework_with_both_slices_is_one() {
        let root = framework("whole");
        let note = checked(&root).unwrap();
        assert!(note.contains("ios-arm64 0.0 MB, ios-arm64-simulator"), "{note}");
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn the_framework_that_was_built_here_is_one() {
        assert_eq!(check_if_there(&Workspace::open().root), Ok(()));
    }

    #[test]
    fn what_is_missing_or_of_another_platform_is_found() {
        /// Done to the root, and to a file of the slice for devices.
        type Damage = fn(&Path, PathBuf);
        let device = |root: &Path, file: &str| root.join(FRAMEWORK).join("ios-arm64").join(file);
        let damages: [(&str, Damage); 5] = [
            ("lib.a", |_, library| fs::write(library, archive(PLATFORM_IOS_SIMULATOR)).unwrap()),
            ("lib.a", |_, library| fs::remove_file(library).unwrap()),
            ("Headers/FieldwalkFFI/FieldwalkFFI.h", |_, header| fs::write(header, "int b;").unwrap()),
            ("Headers/FieldwalkFFI/module.modulemap", |_, map| fs::write(map, "module Other {}").unwrap()),
            ("lib.a", |root, _| {
                let list = root.join(FRAMEWORK).join("Info.plist");
                let text = fs::read_to_string(&list).unwrap().replace("SupportedPlatformVariant", "Other");
                fs::write(list, text).unwrap();
            }),
        ];
        for (k, (file, damage)) in damages.into_iter().enumerate() {
            let root = framework(&format!("damaged-{k}"));
            damage(&root, device(&root, file));
            assert!(checked(&root).is_err(), "{k}");
            fs::remove_dir_all(root).unwrap();
        }
    }
}
