#!/usr/bin/env bash
# A disk image of Gaitwright.app, which packaging/build.py makes on macOS. Not run: no Mac was at hand.
#     python3 packaging/build.py && bash packaging/installers/macos.sh
# With SIGN_AS (a "Developer ID Application") it is signed, with NOTARY (a profile of notarytool) notarised; without
# both, whoever gets it has to allow it in the system's settings.
set -euo pipefail
cd "$(dirname "$0")/../.."

version=$(sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
app=build/folder/Gaitwright.app
image=dist/gaitwright-$version-macos-$(uname -m).dmg
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT

if [ -n "${SIGN_AS:-}" ]; then
    # Rerun's viewer is a program of its own inside
    find "$app" -type f \( -name '*.dylib' -o -name '*.so' -o -perm -u+x \) -exec \
        codesign --force --timestamp --options runtime --sign "$SIGN_AS" {} +
    codesign --force --timestamp --options runtime --sign "$SIGN_AS" "$app"
    codesign --verify --deep --strict "$app"
fi
cp -R "$app" "$stage/"
ln -s /Applications "$stage/Applications"
cp LICENSE "$stage/"
cp -R build/folder/gaitwright/licences "$stage/licences"
mkdir -p dist
rm -f "$image"
hdiutil create -volname Gaitwright -srcfolder "$stage" -format ULMO "$image"
if [ -n "${NOTARY:-}" ]; then
    xcrun notarytool submit "$image" --keychain-profile "$NOTARY" --wait
    xcrun stapler staple "$image"
fi
