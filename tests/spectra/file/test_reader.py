"""Spectra files are read as this program wrote them, or as its earlier version did, or refused in one sentence."""

from __future__ import annotations

import base64
import io
import shutil
import zlib
from contextlib import suppress

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rocking_cli import OutputError, UsageError
from rocking_cli.spectra.file.digest import digest_line
from rocking_cli.spectra.file.reader import SpectraFile


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damaged_bytes_are_a_sentence_or_found_by_verify(spectrum_file, tmp_path, data):
    raw = bytearray(spectrum_file.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        raw = raw[: data.draw(st.integers(0, len(raw)))]
    damaged = tmp_path / "d.h5"
    damaged.write_bytes(raw)
    with suppress(OutputError, UsageError), SpectraFile(damaged) as file, SpectraFile(spectrum_file) as whole:
        if not file.damaged_chunks() and file.complete and file.scene == whole.scene:
            ours, theirs = file.block(0, slice(None)), whole.block(0, slice(None))
            assert np.array_equal(ours["outcome"], theirs["outcome"])
            assert np.array_equal(ours["theta_ratio"], theirs["theta_ratio"], equal_nan=True)


@pytest.mark.parametrize("content", [b"", b"not HDF5 at all", b"\x89HDF\r\n\x1a\n" + b"\x00" * 100])
def test_foreign_files_get_a_sentence(refused, tmp_path, content):
    (tmp_path / "x.h5").write_bytes(content)
    assert "x.h5: is" in refused(1, "info", "x.h5")
    with h5py.File(tmp_path / "y.h5", "w") as file:
        file["x"] = 1
    assert "is not a spectra file" in refused(1, "info", "y.h5")
    assert "no such file" in refused(2, "convert", "nowhere.h5")


def linked(link):
    def edit(file):
        del file["p"]
        file["p"] = link

    return edit


def virtual(file):
    del file["p"]
    layout = h5py.VirtualLayout((1,), "<f8")
    layout[:] = h5py.VirtualSource("other.h5", "p", (1,))
    file.create_virtual_dataset("p", layout)


def external(file):
    del file["bookkeeping/chunk_done"]
    file["bookkeeping"].create_dataset("chunk_done", shape=(8,), dtype="u1", external=[("/etc/passwd", 0, 8)])


def uncut(file):
    del file["outcome"]
    file.create_dataset("outcome", shape=(1, 200, 201), dtype="u1", chunks=(1, 25, 200))


HOSTILE = {
    "a virtual dataset": (virtual, "its p is stored in another file"),
    "values of another file": (external, "its chunk_done is stored in another file"),
    "a soft link": (linked(h5py.SoftLink("/alpha")), "its p is not a dataset of its own"),
    "an external link": (linked(h5py.ExternalLink("other.h5", "p")), "its p is not a dataset of its own"),
    "chunks of another shape": (uncut, "does not fit its axes"),
    "no axis": (lambda file: file.__delitem__("A"), "no axes"),
    "no scene": (lambda file: file.attrs.__delitem__("scene"), "scene"),
    "no parameter": (lambda file: file.__delitem__("gravity"), "gravity"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_what_stands_elsewhere_is_not_read_even_with_a_digest(spectrum_file, tmp_path, case):
    edit, words = HOSTILE[case]
    path = tmp_path / "altered.h5"
    shutil.copy(spectrum_file, path)
    with h5py.File(path, "r+") as file:
        edit(file)
    with open(path, "r+b") as raw:
        line = digest_line(raw, [])
        raw.seek(0, 2)
        raw.write(line)
    with pytest.raises(OutputError, match=f"is not a spectra file as this program wrote it.*{words}"):
        SpectraFile(path)


def test_a_file_that_another_program_has_changed_is_refused(spectrum_file, tmp_path):
    path = tmp_path / "altered.h5"
    shutil.copy(spectrum_file, path)
    with h5py.File(path, "r+") as file:
        file.attrs["remark"] = "mine"
    with pytest.raises(OutputError, match=r"altered\.h5: is not a spectra file as this program wrote it: changed by another one"):
        SpectraFile(path)


EARLIER = """
c-
rkf4R9RQd2jDdr;}t`vH;^h?B(P?Z0U6WKQdqoSwb#Gb|vE^2>HCXyC*HaKi}=i5{?G~h7?E)H1SNFrX&v2CWT2RoeV!2k`&TVk~CyW+LU%YC6H;7X_^uYv}0!4xbJuMc6}$E<r6
WU{WSKwefz%eeee5wKfCYkgM&K;7B{bK1_(SJ-~w%chjSDTPnoaT{R3cj*gd#o*s<shhZkQtm(c8!>q)xkT9TgbAZfD$2q?X3HRJ@A-w67zAa`D)>HpCb{0X>(;KAE>=r{N6-
i4W`5)|mYMw<2wbOn5Y0C3RjR+<jy<%3#oTr3q-SuaY!N%I%ev`Fv!eF2{zUb|?1FC}!uJE;~+T0ZCP5xuz3mVgwDhEzE&M<a=lnuvNkMQ=$jmSw$MR7<ej=n-
#D%Bl!M)ukK!z62@)t5Hx^K`O$VI;3hsOtSlmmQ{18#*A9RMG7z%)(d}0nZkr*TtV9KH>3`KXQXUOnYkq;OR|(v`J%~EzFd?sQ{&pCnnRSwi_)Z~Pm^Lt#}ML_RuXq-
)p0~?6eGvcf5A>Mlt@G(u~<A3G79#Z3xztxXfWiDL}Q@<DwECYL~x_tl9p3D#egVJ%aE;3B%+co6?NPIKbAutwKM7q#zO&Ehd&mGB_i=Cyfq;ev-zARQ_)J<LPpce%1rChMfFfw&
B@b74ir;KCA4v~<a`cRm*c9-
<O@at!mFZYkZ>}PQ>logqvtbfQOaSN<;s~1%+j(2N!Ae~X(>~JE%F{JL$aE#5yj)WCd#>kSTIl`V@IhyHPG~ang;#BXjdT66%6hT27CPeo^ay!9<gY$)^b+t>Vm36I)=Z-i<%<#-
Vo@C_k=pJj_~gwyoKu&Lt<B6?AEh|?(|f*-
kr}VA>Twq>^cNX<e?cKE^4|8e;>{l4?^=31CS55#n&1w{$WxaiefaM;Sq5G&_u7lMpLM$LPpZl`C=AHb(fYaPl;3UXfhf`vdw5I8Ji;dAqIUR>_vrXeS&ye2>P-
whVpXdYym0O8}x;J#Mfkv<Uogy`2r|wB0_Q?TGZ#qIZ8T0u>2%LE|jq)eiZVsFNkvRuaI}_=opHPly4Rv0^I?ewpips9U3eG<~S6v$n7ecqCg<#)1p41iiWSl{3TWJS=^!_8<?Vj
Xjr<KNBU2Wi``-YaAEO0dP`~AU6G#QOCpUJBB8knM;dYbI?!%ue^FAzQda=5j)J8#oEh;A=U++hGrPHEsaZbG8M-)KMz5KCWN5P*<V=)u<H!K7u0n5lmG-
Zo=}JZ~ucp(Qtf@I2sRagX=)GkWr_AN7^jB4(znZ2SnZM`~<X0?1xu$hdl4TVI5ky}^E-2EF3$CeB&zdUrtfi^Q>cQHghBaQymvf4_wkq_mwZx+=)MgN-UV6>sYvw#{@ZC{`?z$>
`)1ioQKO+^#q0C{V(>bYFwG6-pTK;Cnr!+;1>Kbt<DOK78+pbI3bz@`QDh^3Q;^7IksN#aq&vL3F=8Ix3uZwa%TPW+Q0ybCSe~Tsmeriyimi)h<2Gv!iy*`V-
<jXp&TQ&S|KZ^@_J;|7Y944v3pbh|WZ8RVW?~z`I&y>>8zgT`+(lQVylP@8XIUVK!5USG7aFupOs<bm&rJXU0excx@HlTVY;J5&HM;l9`BEil}f(k)BkFFvYi_`L~zkuCvPE_(am
0l+-d>o+&JyrPFYKfP9!+l+$AaM+i6F9smLK&r|b+v@cU0<c18>-
ZEBTboH%Q+1P5Y(4;LbV<4%1U=aV<R>SeG=DPVjhYlf$_Fc{6U(gGSWdcnCgi~<y2UXq!N*6C?1y7NLcd6!a*q(mXugL9SNi(N;n#q)v!MuiU&f8a6}C#YFL3c;?XoyD|o{NY_P!
w8!jsl;D`{#WDgC@ZFI!@3LUUL3e5RW(*f2S#(2kr@f~yx#6w4nPNBRUm`2ca?F4M6^}690)`R0c>N!>j0xsER^bsCYe}U3l1V#h>8>IQom`*028&9H10UMvrLGLP#-
eOaa#p<{?`W+no);iGZ=IAZO^!$b#J@Bt@SMSIOoj0^`csq99+CMb1bN5hkq_1~ZKi9&6;lVw)5(lp$wp8{nbRybuB`~XTkvUyoqn){CmVhX4n_${I#d5r7+yDHgy@NX-M-
J3N0Vtc=Gwd#_W!Kq%7jUU2R0`=$*;HP}IANt8UUz8Ezz8e_-
g1~{L(cQK+5@H_Cyb}|f_YZQ()4ih)tmP28i3p_L(T9Lc^rCpwHy2jp>8MKwCJC01%Kxu<1u6c<Ig{_3Ov(5GSD30)#CeW!9H37O&Z#c|J)0{?jS=KG+X|~4^H~QWCJ0J+BT6M3V
;C@$w0by?#c$h11^GsCX$c*$FV55k=BAN`^j&Ax(E22gj1xcue|eT*Mrvqp@H&OJbSVaJnkeJ$Uw(VytfBD-biSmSyATJcSnGaW+1P>|H*gvgPfaGi^4;!WkU-
5C2c;+|N0A?C%`ff$v`uu7he3Mqc8pSJ<XRxq{RAfA`|IBe%7&_TF>M30^1xfYp{mO2z$VOfe^qmMP7O!=O7n&49}Yc_#X#R170=Z^=h&{u%GG^Px5)?nyl7jOC~!4KXH+I@alt`
8WfHIymgtZ(`4P?EqZ}t{|0I+c*?^Y4tT~*is9M+TW&%PPx*O+18I7JC-1y%nvBfkPT)Abz!PuY6~XU4L<V@u>}w(yIA(01vPP5R(2CE0rK0{Dxd`0C^_;-
cbG}cPEZ#O^&T?F2skn{C^z9(r0>bB<)*jSh=|NAdSg0O!3CFKYm!kGqdU_{af{I)6$LNxczoL}hrV}x7y8t=m<s;B`34%~DCeL3^Pp>quRn<>UZCty*Sw&8trt+Au<bR7US^Psq
`Lu7Jk&{_2f@P*W-=2O3uL0u?_1@agRu-E%Jbv|*)VHZBo}0tNE9Do(U-
fz%9A2*>kEU7e$tt(`+f&0epyG&de)h!2jdspH7Sme3YSgf49=+1r+b(uwc?HMc6}X*y=>1lRvz*i0uAL)$Ni=VxE1I5J<j?!jm7G4R@x$a2pi5(ZMhJZALo$>4pzQPS*VfZMot&
Po;`H#3YcI||2S!Hvjp>8XERaDAxN-Q#(+gn5OSo1nTOcdGx*le7u?^kGF|-
;FOW{PP0Y%IfJRNG<%ml(7^*rUd@7_zmYEOFWX|=pwmUC8n%3F`9I$wC@#|VCV(bl|@Yu$<kvgVcGQZQ$c<7h22XE!qER$|VbR&)N&3rE8^wrru#vV;c!xC@gwcKeU4*4_L8S$AU
nLRt4J&bq%XRvv@)(%L_2)Z8}5n4$jmbPZcmYOJ=V^Z>nPiZfm+a+vvBQu~^c!@Q;>!gMQp)C8V7{BZ|a2YR3a-{-
FbiN+mao!LiN8hYl@kNsin>*U6TvadCq9X;Gp*}hI~{KMOqSV6v416l-rVAQL_vcvrY{loo3ef_lFWe!p=dTdxy^*Jq!@n^i<0V-+Xd}sq~xl^2#-ye3H+j}Zh**-t`-
nz+GPkU?N^mr|2S4({t*IVN?xrS4>!0LD6X~y0cTRmW%fTGdAe(zB)IE04>tN!Y>EqH9Z8jOCVF9^nP+1t9J3Gg5uFaFaV`*wimu%rLzkyocdN<e5sSO5HO@Kc<-;rN-
m!Edp*bR0{44nMwL4j%gA|DFVJWD5)Y<V)i}1HA%j-Zu_Jeh<Egd+yJD{0n#5&zKf?O?Kv0JECI4d5DsXE`nHy@d$tzf$>m+SPFZ6huVcfny8b#d_qmd@C{-
k?9~fuC&r>TF%b5`8?{dM7=_vld%cZX-qClD@3FP}!L5N@&BZ700*$vjKE(Z#!_q%F>b7Rmf@Sno2fHS#&4SY`Plsi#xLW?){aqXB@0<={Mn-
4vcF}x3kF4{@alYVS^`ZV!0Huj?I-OCC@&e6Q)O1GDRf9hdm9Nv`+S)h6x<Fa>)N>rSt`4)YbsW9*CO>F_^p=C<fR@SZlQLyWu$r8!`2&;fOnW_;PdT532CUD?-
_0C<8!&%`dHJccf;}<1n=RK{EZ3bijQg#A#Kt?Hp|9b!33H9Vq*x_StB0LL>tHAAIeM{K{Q91{`8DxRD?hwH3#R#;$8a>_$0E5FYWCL?yU+Jmp`Lo^s)HW*XA3?Py+!bEIe@JjPf
j9#Eg5m&M28Bbk)ua$IGnBqH%D&?<`2`$s!~qNjn~rN{TzSY3*@gM%XQdt9U;%OgiE>K^;q!#dzBgQ#2WMUE!Uc_uUlunesF{N`hCl^iuLQj(ytrp7X<1-
7aHMY`r>c_%oX8E@r7E^=mGV8e+xC~-sj)zc;w}mzRV(9t#UCUm&dI6>T-
EFQCTkaf6B@~&Bd=(^G|=M9w&skSA2w7BJ_MC(s@gRf_1%lei5mO(`$TzM*4}%U{1yBlegQ2kk|De!kN)0f@VB92I?NiZm2^X3vu+&UW<Xj9XA;pnGtN;_iwKV#wtjY@iqwC*dn-
$MLhh*2iw>pxR@w}Ubd-4a2XwRfpuYmixF?Y`-xarCb-yIi&NDl)}aY5w&da_TW?v<Cb*0-
3f)r2`Z&SGblONaQ?cGoaIqzs7QCY=iML%DYpyP~Leoe$6B(<oF1A?HjKg9Q?W17|7hG)VW(m0|PpI<2QaQ^kKyb0eoCaKg?SQ#70PCM^Pseb&bzK9B&d9p@^0`Sk4}<Pfy5RArz
*)Pl>3F-@T==aVK6&S-
5#y6R)pO%7=J1_d{Uuq=)lxs&jn430+<bIGLmQi>=fuCCtG|KsQY9~!(S){Cqn84Xj+>JM+39^@a%kk_fOlWlP(P}({SID_i`cvz@1#r8_&FDyuW@ut`k0W43b?R$QJT44J|j&-
A5AJ6+T&OQok5PyHaZ_&g!nLy6QI%F1B~^H%Dt2u<H>3!Q<|l`n|nTk_$`)mNwlGo>9*=RiJ|?>@rPokwz2ji++;y5CQ-#T;NN!JFTeBLdz0Jd_W!-
Z{rv*;wR0Az^=*J7bXvTz!Wgg;yfIq2oM4&Jd4LTz*kFSVHrQZ;4K~<tslk+x+Kv})&YhDF95`_H%zdZ6y9PAh>iAu?nMF&Dlz&EN3N1CxEE?~qZDt|ZO0&TR8*H$_1{-
X!!G=q4W+5wSH+m-
Mfs+i+<KKJq`N!V;WUMb2{@a&+NM{`1_^;G+XO6x2`Wlcv;h97jDF=E+?yh!>we>h%_RN|+qTMS^XYxg{q!u;&Oo&YyKCH*>GB~@$HYgixu)zi!Y_P!w8*H$_1{*FvxM}asA>c6`
!Fu{P-~2?G9zWLJPT&7;zvq#Ue9RWtWvG9AI5U49?;qd$(lOH+wwr$OsmDx*&Hnh<=%1R7qP-
^3`gzkKy1r%iJz+ZW_t*Zer%cDiKD)v7UDNr#cOC6`*>u$G?xl~tY&yyIp|elFY&r$_Q-
fotO^5%k3^u=MI`j9Z>%Z_T)8V}NVAHQnN8O%z=QqDI9csH$`TiNx3B2hypMA%4KJUtye)c~P{qp$bpnvmWgHRx^<CQ#NGXVdLH;xEjc7XkOJIKZ-UOR5y1%bpk@-
6pH0h$SU+q<YsS}w^x45Q`7ak*-
5e=}fjnWu}Yn#7+<1GD0}47?>64}CPLlq?<83I$cEslGPC?}VhI@7^WlOuhs$=f?A3Jo?qO8p^xr+w*FnR6~1gu;CI97bgElcAI(g$prHY`W?R-c89d#-
5TgyXITktlTnMse6fbz9tggFJvmha`LBw;PL)helRLHS_F=nh99;ZhbmrQv;<Ch#651iDYm+L)tcK^X;AOSaon>X*sB!K%a>dMUnk4_FE>L59Z8PE1k9*a??_v&*d<tx~`eyJ}ad
?%!9X31PGj!Hero(@3tfuz!?I52gt4(ga+|A!J0~b&)+Qr40R}FYZzgEuHV3#v^%@}V+!?nrzLi~THWf$aDx_7FVR@O@oFko*n{*89!X!8+oNxKVuwlw6AhtTI?v#Ktk9m(jC+$j
2-t3MQujdhBn@JB4vDTV@}D839uV(@k>7){`>qLPhl=)oTQPMKdyL=?ZOq+@}&6bbmlk+7`96eS`{34bINPACy26^*3)!Jq;QMWtvgoJvGhC87qEs1o-
cZ8kn~s!AC#Ao>XeBC+QG2aW`+@B
"""


def test_a_file_of_an_earlier_version_is_read(rocking, tmp_path):
    """2 x 3 cells in two chunks, as version 0.1.0 wrote them, with the bookkeeping at the root."""
    (tmp_path / "old.h5").write_bytes(zlib.decompress(base64.b85decode("".join(EARLIER.split()))))
    with h5py.File(io.BytesIO((tmp_path / "old.h5").read_bytes())) as file:
        assert file["chunk_done"].shape == (2,)
        expected = file["theta_ratio"][...]
    info = rocking("info", "old.h5", "--verify")
    assert info.returncode == 0, info.stderr
    assert "2 of 2" in info.stdout
    with SpectraFile(tmp_path / "old.h5") as file:
        assert np.array_equal(file.array("theta_ratio"), expected, equal_nan=True)
    assert len(rocking("convert", "old.h5").stdout.splitlines()) == 7
    assert rocking("plot", "old.h5", "-o", "old.svg").returncode == 0
    (tmp_path / "b.yaml").write_text("{kind: block, width: 0.5, height: 2, restitution: 0.9}")
    assert "capacity_demand" in rocking("predict", "old.h5", "b.yaml", "--A", "2", "--Omega", "2").stdout
