//! Completions and manual pages.

use super::*;

#[test]
fn completions_of_each_shell_know_the_options() {
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let output = run(&["completions", shell]);
        assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
        for option in ["picture", "symmetries", "eigen"] {
            assert!(stdout(&output).contains(option), "{shell} does not know {option}");
        }
    }
    assert_eq!(run(&["completions", "abacus"]).status.code(), FAILED);
}

#[test]
fn each_command_has_a_manual_page() {
    let folder = folder("manual");
    let output = run(&["manual".as_ref(), folder.as_os_str()]);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let pages =
        ["-completions", "-detect", "-eigen", "-info", ""].map(|command| format!("intrinsym{command}.1"));
    assert_eq!(names(&folder), pages);
    let page = std::fs::read_to_string(folder.join("intrinsym-detect.1")).unwrap();
    assert!(page.contains("REPORT.json") && page.contains("symmetries"), "{page}");
    let output = run(&["manual".as_ref(), folder.join("missing").as_os_str()]);
    assert_eq!(output.status.code(), FAILED);
    assert!(stderr(&output).contains("missing"), "{}", stderr(&output));
}
