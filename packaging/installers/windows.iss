; An installer of the folder that packaging/build.py makes on Windows, for Inno Setup 6.3 or newer. Not run: no Windows was at hand.
;     python packaging\build.py
;     iscc packaging\installers\windows.iss
; For this user without an administrator, or for all with one. What users recorded (%LOCALAPPDATA%\gaitwright) is left.

#define VersionFile FileOpen(SourcePath + "\..\..\build\version.txt")
#define Version FileRead(VersionFile)
#define Folder SourcePath + "\..\..\build\folder\gaitwright"

[Setup]
AppId=gaitwright
AppName=Gaitwright
AppVersion={#Version}
AppPublisher=The authors of Gaitwright
AppComments=Research use. Not a medical device.
DefaultDirName={autopf}\Gaitwright
DefaultGroupName=Gaitwright
DisableProgramGroupPage=yes
PrivilegesRequired=lowest
PrivilegesRequiredOverridesAllowed=dialog
ArchitecturesAllowed=x64compatible
ArchitecturesInstallIn64BitMode=x64compatible
LicenseFile=..\..\LICENSE
OutputDir=..\..\dist
OutputBaseFilename=gaitwright-{#Version}-windows
Compression=lzma2/max
SolidCompression=yes
LZMANumBlockThreads=2
CloseApplications=yes
UninstallDisplayIcon={app}\gaitwright-window.exe

[Languages]
Name: "en"; MessagesFile: "compiler:Default.isl"
Name: "de"; MessagesFile: "compiler:Languages\German.isl"

[InstallDelete]
; parts of the version before
Type: filesandordirs; Name: "{app}\_internal"

[Files]
Source: "{#Folder}\*"; DestDir: "{app}"; Flags: recursesubdirs ignoreversion

[Icons]
Name: "{group}\Gaitwright"; Filename: "{app}\gaitwright-window.exe"; Comment: "Research use. Not a medical device."

[Run]
Filename: "{app}\gaitwright-window.exe"; Description: "{cm:LaunchProgram,Gaitwright}"; Flags: nowait postinstall skipifsilent
