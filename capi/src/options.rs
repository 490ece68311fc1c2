//! `isym_options_*`: options by name, and the table that describes them.

use super::handles::Table;
use super::memory::{Output, Versioned, array, text};
use super::status::{Fault, ISYM_ERROR_INDEX, ISYM_ERROR_OPTION, Result, boundary, isym_status};
use intrinsym::{OPTIONS, Options};
use std::ffi::{CString, c_char};
use std::sync::{LazyLock, Mutex, PoisonError};

/// A set of options. Made with the defaults; one set may be used for any number of calls, from any thread.
pub struct isym_options(());

/// Live option sets.
pub static OPTION_SETS: Table<isym_options, Mutex<Options>> = Table::new("options handle");

/// What a host needs to show an option.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct isym_option_spec {
    /// `sizeof` of this struct, set by the caller before the call.
    pub size: usize,
    /// Name for `isym_options_set`. Never freed.
    pub name: *const c_char,
    /// One sentence for dialogs, in English. Never freed.
    pub help: *const c_char,
    /// Names of the values from 0 on, with `|` between them; NULL where values have none. Never freed.
    pub choices: *const c_char,
    /// Value used when none is set. All values are whole numbers.
    pub default_value: f64,
    /// Smallest accepted value but for the default.
    pub minimum: f64,
    /// Largest accepted value.
    pub maximum: f64,
    /// 1 if only experts need it, otherwise 0.
    pub is_expert: i32,
}

// SAFETY: as declared above.
unsafe impl Versioned for isym_option_spec {}

/// The table's texts as C reads them.
static TEXTS: LazyLock<Vec<[CString; 3]>> = LazyLock::new(|| {
    let of = |text: &str| CString::new(text).unwrap_or_default();
    OPTIONS.iter().map(|spec| [of(spec.name), of(spec.help), of(&spec.choices.join("|"))]).collect()
});

/// The options of a handle, as they are now; the defaults for NULL.
pub fn options_of(handle: *const isym_options) -> Result<Options> {
    if handle.is_null() {
        return Ok(Options::default());
    }
    let options = OPTION_SETS.get(handle)?;
    let options = options.lock().unwrap_or_else(PoisonError::into_inner).clone();
    Ok(options)
}

/// Number of options in the table.
///
/// @return One more than the largest index of `isym_option_describe`.
#[unsafe(no_mangle)]
pub extern "C" fn isym_option_count() -> usize {
    OPTIONS.len()
}

/// Describes an option.
///
/// @param index From 0 to below `isym_option_count()`.
/// @param[in,out] spec Its `size` is set before the call.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_SIZE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_option_describe(index: usize, spec: *mut isym_option_spec) -> isym_status {
    boundary(|| {
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::structure(spec, "spec") }?;
        let Some((found, [name, help, choices])) = OPTIONS.get(index).zip(TEXTS.get(index)) else {
            let message = format!("there is no option {index}, only {}", OPTIONS.len());
            return Err(Fault::new(ISYM_ERROR_INDEX, message));
        };
        output.write(&[isym_option_spec {
            size: size_of::<isym_option_spec>(),
            name: name.as_ptr(),
            help: help.as_ptr(),
            choices: if choices.is_empty() { std::ptr::null() } else { choices.as_ptr() },
            default_value: found.default as f64,
            minimum: found.minimum as f64,
            maximum: found.maximum as f64,
            is_expert: i32::from(found.expert),
        }]);
        Ok(())
    })
}

/// Makes a set of options with the defaults.
///
/// @param[out] options Free it with `isym_options_free`.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_options_new(options: *mut *mut isym_options) -> isym_status {
    boundary(|| {
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(options, 1, "options") }?;
        output.write(&[OPTION_SETS.insert(Mutex::new(Options::default()))]);
        Ok(())
    })
}

/// Sets an option. On failure nothing changes.
///
/// @param options The set.
/// @param name The option's name, UTF-8.
/// @param value A whole number in the option's range.
/// @return `ISYM_OK`; `ISYM_ERROR_OPTION`: there is no such option, or `value` is outside its range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_options_set(
    options: *mut isym_options,
    name: *const c_char,
    value: f64,
) -> isym_status {
    boundary(|| {
        let options = OPTION_SETS.get(options)?;
        // SAFETY: the caller's one promise.
        let name = unsafe { text(name, "name") }?;
        let mut options = options.lock().unwrap_or_else(PoisonError::into_inner);
        options.get(&name)?;
        // Larger numbers than these are outside every range.
        if value.fract() != 0.0 || !(0.0..=1e15).contains(&value) {
            let message = format!("option {name}: {value} is not a whole number in its range");
            return Err(Fault::new(ISYM_ERROR_OPTION, message));
        }
        Ok(options.set(&name, value as usize)?)
    })
}

/// Reads an option.
///
/// @param options The set; NULL for the defaults.
/// @param name The option's name, UTF-8.
/// @param[out] value Its value.
/// @return `ISYM_OK`; `ISYM_ERROR_OPTION`: there is no such option.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_options_get(
    options: *const isym_options,
    name: *const c_char,
    value: *mut f64,
) -> isym_status {
    boundary(|| {
        let options = options_of(options)?;
        // SAFETY: the caller's one promise, for both.
        let (name, output) = unsafe { (text(name, "name")?, Output::new(value, 1, "value")?) };
        output.write(&[options.get(&name)? as f64]);
        Ok(())
    })
}

/// Takes a sign network (ONNX) of your own instead of the embedded one; it is trusted input.
///
/// It runs in the ONNX Runtime library (1.24 or newer) that the environment variable `ORT_DYLIB_PATH` names. Whether it can be
/// used shows when it is: `ISYM_ERROR_MODEL`.
///
/// @param options The set.
/// @param path The file, UTF-8. An empty text takes the embedded network again.
/// @return `ISYM_OK`, `ISYM_ERROR_TEXT`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_options_set_model(
    options: *mut isym_options,
    path: *const c_char,
) -> isym_status {
    boundary(|| {
        let options = OPTION_SETS.get(options)?;
        // SAFETY: the caller's one promise.
        let path = unsafe { text(path, "path") }?;
        let model = Some(path).filter(|path| !path.is_empty()).map(Into::into);
        options.lock().unwrap_or_else(PoisonError::into_inner).model = model;
        Ok(())
    })
}

/// Tells the signs that a person knows. They overrule the network; the last call counts.
///
/// @param options The set.
/// @param signs Of the first eigenfunctions of `isym_mesh_eigen`: 1 even, -1 odd, 0 unknown.
/// @param count Number of signs.
/// @return `ISYM_OK`; `ISYM_ERROR_OPTION`: a sign is another number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_options_set_known_signs(
    options: *mut isym_options,
    signs: *const i8,
    count: usize,
) -> isym_status {
    boundary(|| {
        let options = OPTION_SETS.get(options)?;
        // SAFETY: the caller's one promise.
        let known_signs = unsafe { array(signs, count, "signs") }?;
        let mut options = options.lock().unwrap_or_else(PoisonError::into_inner);
        let changed = Options { known_signs, ..options.clone() };
        changed.validate()?;
        *options = changed;
        Ok(())
    })
}

/// Frees a set of options.
///
/// @param options The set; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn isym_options_free(options: *mut isym_options) -> isym_status {
    boundary(|| OPTION_SETS.remove(options))
}
