#!/usr/bin/env bash
# An AppImage of the folder in dist/*.tar.zst. Not run: appimagetool is no package of any registry that was at hand.
set -euo pipefail
cd "$(dirname "$0")/../.."

version=$(sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
place=build/appimage/Gaitwright.AppDir
rm -rf build/appimage
mkdir -p "$place/usr/share/icons/hicolor/scalable/apps"
tar --extract --zstd --file "$(ls dist/gaitwright-*-linux-*.tar.zst)" --directory "$place" --strip-components 1
sed 's,^Exec=.*,Exec=gaitwright,' packaging/installers/gaitwright.desktop > "$place/gaitwright.desktop"
cp packaging/installers/gaitwright.svg "$place/gaitwright.svg"
cp packaging/installers/gaitwright.svg "$place/usr/share/icons/hicolor/scalable/apps/"
printf '#!/bin/sh\nexec "$(dirname "$(readlink -f "$0")")/gaitwright" "$@"\n' > "$place/AppRun"
chmod +x "$place/AppRun"

# of the project AppImage/appimagetool, release 1.9.0; its digest belongs beside it before anybody is given the result
tool=${APPIMAGETOOL:-appimagetool}
ARCH=$(uname -m) "$tool" --no-appstream "$place" "dist/gaitwright-$version-$(uname -m).AppImage"
